// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/files/ply_file.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <sstream>
#include <vector>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include "tools/meshing/files/scanner.hpp"

namespace palpate::meshing {
namespace {

struct Type {
    std::size_t size;
    double (*read)(Scanner&, std::endian);
};

template <typename T>
constexpr Type type_of{
    sizeof(T), [](Scanner& file, std::endian order) { return static_cast<double>(file.raw<T>(order)); }};

const std::map<std::string, Type, std::less<>> types{
    {"char", type_of<std::int8_t>},     {"int8", type_of<std::int8_t>},
    {"uchar", type_of<std::uint8_t>},   {"uint8", type_of<std::uint8_t>},
    {"short", type_of<std::int16_t>},   {"int16", type_of<std::int16_t>},
    {"ushort", type_of<std::uint16_t>}, {"uint16", type_of<std::uint16_t>},
    {"int", type_of<std::int32_t>},     {"int32", type_of<std::int32_t>},
    {"uint", type_of<std::uint32_t>},   {"uint32", type_of<std::uint32_t>},
    {"float", type_of<float>},          {"float32", type_of<float>},
    {"double", type_of<double>},        {"float64", type_of<double>}};

struct Property {
    std::string name;
    Type type;
    std::optional<Type> count;  // of a list
};

struct Element {
    std::string name;
    std::int64_t count;
    std::vector<Property> properties;
};

class PlyReader {
  public:
    explicit PlyReader(const std::filesystem::path& path) : file_(path) { points_->SetDataTypeToDouble(); }

    vtkSmartPointer<vtkPolyData> read() {
        read_header();
        for (const Element& element : elements_) read_element(element);
        if (points_->GetNumberOfPoints() == 0 || faces_->GetNumberOfCells() == 0)
            file_.fail("holds no faces", "the elements vertex and face", "check how it was made");
        auto data = vtkSmartPointer<vtkPolyData>::New();
        data->SetPoints(points_);
        data->SetPolys(faces_);
        return data;
    }

  private:
    void read_header() {
        if (file_.line().substr(0, 3) != "ply") file_.fail("does not begin with 'ply'", "a PLY file");
        while (true) {
            if (file_.at_end()) file_.fail("has no end_header", "", "write the file again");
            std::istringstream line{std::string(file_.line())};
            std::string keyword, word;
            line >> keyword;
            if (keyword == "end_header") return;
            if (keyword == "comment" || keyword == "obj_info") continue;
            if (keyword == "format" && line >> word && (word == "ascii" || word.starts_with("binary_"))) {
                ascii_ = word == "ascii";
                order_ = word == "binary_big_endian" ? std::endian::big : std::endian::little;
            } else if (keyword == "element") {
                Element element{};
                if (!(line >> element.name >> element.count))
                    file_.fail("an element without name and number", "", "write the file again");
                for (const Element& other : elements_)
                    if (other.name == element.name)
                        file_.fail("announces element " + other.name + " twice", "", "write the file again");
                constexpr std::size_t most_elements = 64;
                if (elements_.size() == most_elements)
                    file_.fail("announces more than 64 elements", "", "write the file again");
                elements_.push_back(std::move(element));
            } else if (keyword == "property" && !elements_.empty()) {
                Property property{};
                line >> word;
                if (word == "list") {
                    line >> word;
                    property.count = type(word);
                    line >> word;
                }
                property.type = type(word);
                line >> property.name;
                elements_.back().properties.push_back(std::move(property));
            } else {
                file_.fail(fmt::format("'{}' in the header", keyword.substr(0, 40)),
                           "format, comment, element, property or end_header", "write the file again");
            }
        }
    }

    Type type(const std::string& name) const {
        const auto found = types.find(name);
        if (found == types.end())
            file_.fail(fmt::format("property type '{}'", name.substr(0, 40)), "such as float or int",
                       "write the file again");
        return found->second;
    }

    double value(const Type& type) { return ascii_ ? file_.number() : type.read(file_, order_); }
    std::size_t room(const Type& type) const { return ascii_ ? 1 : type.size; }

    std::int64_t whole(const Type& type) {
        const double number = value(type);
        if (!(std::abs(number) <= std::numeric_limits<std::uint32_t>::max()) || number != std::floor(number))
            file_.fail(fmt::format("{} in a list", number), "a whole number", "write the file again");
        return static_cast<std::int64_t>(number);
    }

    void read_element(const Element& element) {
        const auto find = [&](std::string_view name) {
            for (std::size_t p = 0; p < element.properties.size(); ++p)
                if (element.properties[p].name == name) return p;
            return element.properties.size();
        };
        const bool vertex = element.name == "vertex", face = element.name == "face";
        const std::array<std::size_t, 3> axes{find("x"), find("y"), find("z")};
        const std::size_t corners = std::min(find("vertex_indices"), find("vertex_index"));
        if (vertex)
            for (const std::size_t axis : axes)
                if (axis == element.properties.size() || element.properties[axis].count)
                    file_.fail("vertices without x, y and z", "three numbers", "write the file again");
        if (face && (corners == element.properties.size() || !element.properties[corners].count))
            file_.fail("faces without a list vertex_indices", "their corners", "write the file again");
        std::size_t bytes = 0;
        for (const Property& property : element.properties)
            bytes += room(property.count.value_or(property.type));
        file_.require_room(element.count, std::max<std::size_t>(bytes, 1));

        std::vector<double> numbers(element.properties.size());
        std::vector<vtkIdType> list;
        for (std::int64_t n = 0; n < element.count; ++n) {
            for (std::size_t p = 0; p < element.properties.size(); ++p) {
                const Property& property = element.properties[p];
                if (!property.count)
                    numbers[p] = value(property.type);
                else if (face && p == corners)
                    list = read_corners(property);
                else
                    for (std::int64_t left = length(property); left > 0; --left) value(property.type);
            }
            if (vertex) points_->InsertNextPoint(numbers[axes[0]], numbers[axes[1]], numbers[axes[2]]);
            if (face) faces_->InsertNextCell(static_cast<vtkIdType>(list.size()), list.data());
        }
    }

    std::int64_t length(const Property& list) {
        return file_.require_room(whole(*list.count), room(list.type));
    }

    std::vector<vtkIdType> read_corners(const Property& list) {
        std::vector<vtkIdType> corners(static_cast<std::size_t>(length(list)));
        if (corners.size() < 3)
            file_.fail(fmt::format("a face of {} corners", corners.size()), "3 or more",
                       "write the file again");
        for (vtkIdType& corner : corners) corner = whole(list.type);
        return corners;
    }

    Scanner file_;
    bool ascii_ = true;
    std::endian order_ = std::endian::little;
    std::vector<Element> elements_;
    vtkNew<vtkPoints> points_;
    vtkNew<vtkCellArray> faces_;
};

}  // namespace

vtkSmartPointer<vtkPolyData> read_ply(const std::filesystem::path& path) {
    return PlyReader(path).read();
}

}  // namespace palpate::meshing
