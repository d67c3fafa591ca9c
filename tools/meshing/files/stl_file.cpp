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

    vtkSmartPointer<vtkPolyData> read() {
        if (binary_)
            read_binary();
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

    // Many binary files begin with "solid" too, but only theirs is the size that their count says.
    bool is_binary(const std::filesystem::path& path) const {
        if (size_ < header_size + 4) return false;
        Scanner head(path);
        const auto start = head.raw<std::array<char, 5>>();
        const bool solid = lower_case({start.data(), start.size()}) == "solid";
        head.skip(static_cast<std::int64_t>(header_size - start.size()), 1);
        return !solid || size_ == header_size + 4 +
                                      facet_size * std::size_t{head.raw<std::uint32_t>(std::endian::little)};
    }

    void read_binary() {
        file_.skip(static_cast<std::int64_t>(header_size), 1);
        const auto count = file_.require_room(file_.raw<std::uint32_t>(std::endian::little), facet_size);
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
        if (lower_case(file_.peek()) != "solid")
            file_.fail("does not begin with 'solid'", "an STL file", "check how it was made");
        std::array<vtkIdType, 3> corners{};
        std::size_t found = 0;
        while (!file_.at_end()) {
            const std::string keyword = lower_case(file_.word());
            if (keyword == "solid" || keyword == "endsolid") file_.line();  // a name
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

vtkSmartPointer<vtkPolyData> read_stl(const std::filesystem::path& path) {
    return StlReader(path).read();
}

}  // namespace palpate::meshing
