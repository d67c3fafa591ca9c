// SPDX-License-Identifier: GPL-3.0-or-later
// Legacy VTK files of structured points, read here rather than through VTK 9.1, which crashes where a field
// breaks off. Source: VTK user's guide, "Simple legacy formats".
#include <Eigen/Dense>
#include <algorithm>
#include <charconv>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <span>
#include <string_view>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/read_image.hpp"

namespace palpate::imaging {
namespace {

class LegacyImage {
  public:
    explicit LegacyImage(const std::filesystem::path& path) : path_(path) {
        std::ifstream stream(path, std::ios::binary);
        text_.assign(std::istreambuf_iterator<char>(stream), {});
    }

    StoredImage read(const NoteSink& note) {
        line();  // version
        line();  // title
        binary_ = keyword() == "binary";
        while (image_.voxels.index() == 0 && std::get<0>(image_.voxels).empty()) read_section(keyword());
        if (const std::string more = left() ? keyword() : ""; !more.empty() && more != "metadata")
            refuse("has more at its points than one array of scalars", "one array of scalars");
        if (note && space_.empty()) note("the header names no patient space; taken as LPS");
        Eigen::Matrix3d axes = spacing_.asDiagonal();
        image_.grid.origin = origin_;
        if (space_ == "RAS") {
            axes.topRows<2>() *= -1;
            image_.grid.origin.head<2>() *= -1;
        }
        set_axes(image_.grid, axes);
        check_geometry(image_.grid, path_, note);
        return std::move(image_);
    }

  private:
    [[noreturn]] void refuse(const std::string& found, const std::string& expected = "") const {
        throw InvalidInput(
            {path_.string(), found, expected,
             "check that the file is whole; of .vtk files only STRUCTURED_POINTS are volumes"});
    }

    void read_section(const std::string& name) {
        if (name == "dataset") {
            if (keyword() != "structured_points") refuse("cannot be read as VTK image data");
        } else if (name == "dimensions") {
            std::array<std::int64_t, 3> size{};
            for (std::int64_t& n : size) n = number<std::int64_t>();
            check_size(size, path_);
            std::ranges::transform(size, image_.grid.size.begin(),
                                   [](std::int64_t n) { return static_cast<std::int32_t>(n); });
        } else if (name == "origin" || name == "spacing" || name == "aspect_ratio") {
            for (double& x : name == "origin" ? origin_ : spacing_) x = number<double>();
        } else if (name == "field") {
            read_field();
        } else if (name == "point_data") {
            number<std::int64_t>();  // which the dimensions say
        } else if (name == "scalars") {
            read_scalars();
        } else {
            refuse(fmt::format("has a section '{}'", as_utf8(name).substr(0, 40)),
                   "DATASET, DIMENSIONS, ORIGIN, SPACING, FIELD, POINT_DATA and SCALARS");
        }
    }

    // Only the frame is of interest: one text SPACE, as 3D Slicer writes it.
    void read_field() {
        word();
        for (auto arrays = number<std::int64_t>(); arrays > 0; --arrays) {
            const std::string name(word());
            const auto components = number<std::int64_t>(), tuples = number<std::int64_t>();
            if (keyword() != "string" || components != 1 || tuples != 1)
                refuse("has a field '" + as_utf8(name).substr(0, 40) + "'", "none but SPACE, one text");
            line();
            const std::string_view value = line();
            if (name == "SPACE") space_ = value.substr(0, 3);
        }
    }

    void read_scalars() {
        word();
        const std::string type = keyword();
        if (std::string next = keyword(); next != "lookup_table") {
            if (next != "1") refuse("has several values to a point", "one");
            if (keyword() != "lookup_table") refuse("has scalars without LOOKUP_TABLE");
        }
        word();
        if (type == "unsigned_char") return read_values<std::uint8_t>();
        if (type == "char" || type == "signed_char") return read_values<std::int8_t>();
        if (type == "unsigned_short") return read_values<std::uint16_t>();
        if (type == "short") return read_values<std::int16_t>();
        if (type == "unsigned_int") return read_values<std::uint32_t>();
        if (type == "int" || type == "vtkidtype") return read_values<std::int32_t>();
        if (type == "unsigned_long" || type == "vtktypeuint64") return read_values<std::uint64_t>();
        if (type == "long" || type == "vtktypeint64") return read_values<std::int64_t>();
        if (type == "float") return read_values<float>();
        if (type == "double") return read_values<double>();
        refuse("holds " + as_utf8(type).substr(0, 40), "integers or real numbers");
    }

    template <typename Voxel>
    void read_values() {
        check_size({image_.grid.size[0], image_.grid.size[1], image_.grid.size[2]}, path_);
        if (binary_) line();
        const std::size_t count = image_.grid.voxel_count();
        check_claim(count * sizeof(Voxel), text_.size() - at_, binary_ ? Packing::none : Packing::text,
                    path_);
        std::vector<Voxel> voxels(count);
        if (binary_) {
            const auto bytes = std::as_writable_bytes(std::span(voxels));
            std::memcpy(bytes.data(), text_.data() + at_, bytes.size());
            at_ += bytes.size();
            for (std::size_t at = 0; at < bytes.size(); at += sizeof(Voxel))
                std::ranges::reverse(bytes.subspan(at, sizeof(Voxel)));
        } else {
            for (Voxel& voxel : voxels) voxel = number<Voxel>();
        }
        image_.voxels = std::move(voxels);
    }

    bool left() {
        at_ = std::min(text_.find_first_not_of(white, at_), text_.size());
        return at_ < text_.size();
    }

    std::string_view word() {
        if (!left()) refuse("holds fewer voxels than its header claims");
        const std::size_t end = std::min(text_.find_first_of(white, at_), text_.size());
        const std::string_view found = std::string_view(text_).substr(at_, end - at_);
        at_ = end;
        return found;
    }

    std::string keyword() { return in_lower_case(std::string(word())); }

    std::string_view line() {
        const std::size_t end = std::min(text_.find('\n', at_), text_.size());
        const std::string_view found = std::string_view(text_).substr(at_, end - at_);
        at_ = std::min(end + 1, text_.size());
        return found;
    }

    template <typename Number>
    Number number() {
        const std::string_view text = word();
        Number value{};
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc{} || end != text.data() + text.size())
            refuse("has '" + as_utf8(text).substr(0, 40) + "' in place of a number of its type");
        return value;
    }

    static constexpr std::string_view white = " \t\r\n\v\f";
    std::filesystem::path path_;
    std::string text_, space_;
    std::size_t at_ = 0;
    bool binary_ = false;
    Eigen::Vector3d origin_ = Eigen::Vector3d::Zero(), spacing_ = Eigen::Vector3d::Ones();
    StoredImage image_;
};

}  // namespace

StoredImage read_legacy_vtk(const std::filesystem::path& path, const NoteSink& note) {
    return LegacyImage(path).read(note);
}

}  // namespace palpate::imaging
