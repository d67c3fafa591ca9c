// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/files/obj_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include "tools/meshing/files/scanner.hpp"

namespace palpate::meshing {
namespace {

// The words of one line.
class Words {
  public:
    explicit Words(std::string_view line) : left_(line) {}

    // Empty after the last one.
    std::string_view next() {
        constexpr std::string_view white = " \t\r\v\f";
        left_.remove_prefix(std::min(left_.find_first_not_of(white), left_.size()));
        const std::string_view word = left_.substr(0, left_.find_first_of(white));
        left_.remove_prefix(word.size());
        return word;
    }

  private:
    std::string_view left_;
};

// It may begin with '+'.
template <typename Number>
std::optional<Number> number_of(std::string_view word) {
    Number number{};
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return number;
}

class ObjReader {
  public:
    explicit ObjReader(const std::filesystem::path& path) : file_(path) { points_->SetDataTypeToDouble(); }

    vtkSmartPointer<vtkPolyData> read() {
        while (!file_.at_end()) {
            const std::string line = next_line();
            Words words(line);
            const std::string_view keyword = words.next();
            if (keyword == "v") add_vertex(words);
            if (keyword == "f") add_face(words);
        }
        if (points_->GetNumberOfPoints() == 0 || faces_->GetNumberOfCells() == 0)
            file_.fail("holds no faces", "lines 'v x y z' and 'f a b c'", "check how it was made");
        auto data = vtkSmartPointer<vtkPolyData>::New();
        data->SetPoints(points_);
        data->SetPolys(faces_);
        return data;
    }

  private:
    // One that ends with a backslash goes on in the next.
    std::string next_line() {
        std::string text;
        while (true) {
            text += file_.line();
            const std::size_t last = text.find_last_not_of(" \t\r");
            if (last == std::string::npos || text[last] != '\\') return text;
            text.resize(last);
            text += ' ';
            if (file_.exhausted()) return text;
        }
    }

    void add_vertex(Words& words) {
        std::array<double, 3> place{};
        for (double& x : place) {
            const std::string_view word = words.next();
            const auto number = number_of<double>(word);
            if (!number)
                file_.fail(fmt::format("'{}'", word.substr(0, 40)), "v x y z", "write the file again");
            x = *number;
        }
        points_->InsertNextPoint(place.data());
    }

    // Corners "vertex", "vertex/texture", "vertex//normal", "vertex/texture/normal"; vertices count from 1,
    // or from the last one, -1, backwards.
    void add_face(Words& words) {
        std::vector<vtkIdType> corners;
        for (std::string_view word = words.next(); !word.empty() && word[0] != '#'; word = words.next()) {
            const auto vertex = number_of<std::int64_t>(word.substr(0, word.find('/')));
            if (!vertex || *vertex == 0)
                file_.fail(fmt::format("'{}' in a face", word.substr(0, 40)),
                           "numbers of vertices, from 1 on", "write the file again");
            corners.push_back(*vertex > 0 ? *vertex - 1 : points_->GetNumberOfPoints() + *vertex);
        }
        if (corners.size() < 3)
            file_.fail(fmt::format("a face of {} corners", corners.size()), "3 or more",
                       "write the file again");
        faces_->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
    }

    Scanner file_;
    vtkNew<vtkPoints> points_;
    vtkNew<vtkCellArray> faces_;
};

}  // namespace

vtkSmartPointer<vtkPolyData> read_obj(const std::filesystem::path& path) {
    return ObjReader(path).read();
}

}  // namespace palpate::meshing
