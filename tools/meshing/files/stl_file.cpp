// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/files/stl_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <string>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include "tools/meshing/files/scanner.hpp"
#include "tools/meshing/files/text.hpp"

namespace palpate::meshing {
namespace {

constexpr std::size_t header_size = 80, facet_size = 50;

class StlReader {
  public:
    explicit StlReader(const std::filesystem::path& path)
        : file_(path), size_(std::filesystem::file_size(path)), binary_(is_binary(path)) {}

    vtkSmartPointer<vtkPolyData> read(const NoteSink& note) {
        if (binary_)
            read_binary(note);
        else
            read_ascii();
        if (triangles_->GetNumberOfCells() == 0)
            file_.fail("holds no triangles", "an STL file", "check how it was made");
        auto data = vtkSmartPointer<vtkPolyData>::New();
        data->SetPoints(points_);
        data->SetPolys(triangles_);
        return data;
    }

  private:
    using Place = std::array<float, 3>;

    // Many binary files begin with "solid" too, and texts with blanks or a byte order mark; but only binary
    // ones are the size that their count says, and only texts have facets with vertices, or say that they
    // end.
    bool is_binary(const std::filesystem::path& path) const {
        if (size_ < header_size + 4) return false;
        Scanner head(path);
        const std::string start = lower_case(head.text().substr(0, 1 << 16));
        const auto has = [&](const char* word) { return start.find(word) != std::string::npos; };
        const bool text = (has("facet") && has("vertex")) || has("endsolid");
        head.skip(static_cast<std::int64_t>(header_size), 1);
        const std::size_t count = head.raw<std::uint32_t>(std::endian::little);
        return !text || size_ == header_size + 4 + facet_size * count;
    }

    // Counts are often those of another file, or 0; what is there counts, unless it ends within a triangle.
    void read_binary(const NoteSink& note) {
        file_.skip(static_cast<std::int64_t>(header_size), 1);
        const std::int64_t announced = file_.raw<std::uint32_t>(std::endian::little);
        const auto count = static_cast<std::int64_t>((size_ - header_size - 4) / facet_size);
        const std::size_t rest = (size_ - header_size - 4) % facet_size;
        if (announced != count && rest != 0)
            file_.fail(
                fmt::format("announces {} triangles, but {} and {} bytes follow", announced, count, rest),
                "an STL file that is whole", "write the file again");
        if (note && announced != count)
            note(fmt::format("{} triangles are announced and {} there, which were taken", announced, count));
        if (note && rest != 0) note(fmt::format("{} bytes after the last triangle were passed over", rest));
        for (std::int64_t n = 0; n < count; ++n) {
            file_.skip(3, sizeof(float));  // its normal
            std::array<vtkIdType, 3> corners{};
            for (vtkIdType& corner : corners) {
                Place place{};
                for (float& x : place) x = file_.raw<float>(std::endian::little);
                corner = index_of(place);
            }
            file_.skip(2, 1);  // "attribute byte count"
            add(corners);
        }
    }

    void read_ascii() {
        std::array<vtkIdType, 3> corners{};
        std::size_t found = 0;
        while (!file_.at_end()) {
            const std::string keyword = lower_case(file_.word());
            if (keyword.ends_with("solid")) file_.line();  // a name; a byte order mark may be before it
            if (keyword == "outer") found = 0;
            if (keyword == "vertex") {
                if (found == 3) file_.fail("a loop of four corners", "three", "triangulate it first");
                Place place{};
                for (float& x : place) x = static_cast<float>(file_.number());
                corners[found++] = index_of(place);
            }
            if (keyword != "endloop") continue;
            if (found != 3)
                file_.fail(fmt::format("a loop of {} corners", found), "three", "write the file again");
            add(corners);
        }
    }

    vtkIdType index_of(const Place& place) {
        if (!std::ranges::all_of(place, [](float x) { return std::isfinite(x); }))
            file_.fail("a corner that is not finite", "", "write the file again");
        const auto [entry, fresh] = index_.try_emplace(place, points_->GetNumberOfPoints());
        if (fresh) points_->InsertNextPoint(place.data());
        return entry->second;
    }

    void add(const std::array<vtkIdType, 3>& corners) {
        if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
            triangles_->InsertNextCell(3, corners.data());
    }

    Scanner file_;
    std::size_t size_;
    bool binary_;
    std::map<Place, vtkIdType> index_;
    vtkNew<vtkPoints> points_;
    vtkNew<vtkCellArray> triangles_;
};

}  // namespace

vtkSmartPointer<vtkPolyData> read_stl(const std::filesystem::path& path, const NoteSink& note) {
    return StlReader(path).read(note);
}

}  // namespace palpate::meshing
