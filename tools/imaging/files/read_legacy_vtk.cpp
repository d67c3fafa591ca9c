// SPDX-License-Identifier: GPL-3.0-or-later
// Legacy VTK files of structured points, read here rather than through VTK 9.1, which crashes where a field
// breaks off. Source: VTK user's guide, "Simple legacy formats".
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>

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
        while (left()) read_section(keyword(), note);
        if (arrays_at_points_ != 1)
            refuse(fmt::format("has {} arrays at its points", arrays_at_points_), "one array of scalars");
        if (note && space_.empty()) note("the header names no patient space; taken as LPS");
        Eigen::Matrix3d axes = spacing_.asDiagonal();
        image_.grid.origin = origin_ + axes * first_;
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

    void read_section(const std::string& name, const NoteSink& note) {
        if (name == "dataset") {
            if (keyword() != "structured_points") refuse("cannot be read as VTK image data");
        } else if (name == "dimensions") {
            std::array<std::int64_t, 3> size{};
            for (std::int64_t& n : size) n = number<std::int64_t>();
            set_size(size);
        } else if (name == "extent") {
            std::array<std::int64_t, 3> size{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::int64_t first = number<std::int32_t>(), last = number<std::int32_t>();
                size[axis] = last - first + 1;
                first_[static_cast<Eigen::Index>(axis)] = static_cast<double>(first);
            }
            set_size(size);
        } else if (name == "origin" || name == "spacing" || name == "aspect_ratio") {
            for (double& x : name == "origin" ? origin_ : spacing_) x = number<double>();
        } else if (name == "metadata") {
            skip_metadata();
        } else if (name == "field") {
            read_field();
        } else if (name == "point_data" || name == "cell_data") {
            at_points_ = name == "point_data";
            in_attributes_ = true;
            attribute_tuples_ = number<std::int64_t>();
        } else if (!in_attributes_ || !read_attribute(name, note)) {
            refuse(fmt::format("has a section '{}'", as_utf8(name).substr(0, 40)),
                   "DATASET, DIMENSIONS, ORIGIN, SPACING, FIELD, POINT_DATA and SCALARS");
        }
    }

    void set_size(const std::array<std::int64_t, 3>& size) {
        check_size(size, path_);
        std::ranges::transform(size, image_.grid.size.begin(),
                               [](std::int64_t n) { return static_cast<std::int32_t>(n); });
    }

    // Whether it is one.
    bool read_attribute(const std::string& name, const NoteSink& note) {
        constexpr std::array<std::pair<std::string_view, std::int64_t>, 7> others{{{"vectors", 3},
                                                                                   {"normals", 3},
                                                                                   {"tensors", 9},
                                                                                   {"tensors6", 6},
                                                                                   {"global_ids", 1},
                                                                                   {"pedigree_ids", 1},
                                                                                   {"edge_flags", 1}}};
        const auto* const other =
            std::ranges::find(others, name, [](const auto& entry) { return entry.first; });
        word();  // its own name
        if (name == "scalars" || name == "color_scalars") {
            read_scalars(name, note);
        } else if (name == "lookup_table") {
            skip_values("unsigned_char", 4, number<std::int64_t>());  // red, green, blue, opacity
        } else if (name == "texture_coordinates") {
            const auto components = number<std::int64_t>();
            take_array(keyword(), components, attribute_tuples_);
        } else if (other != others.end()) {
            take_array(keyword(), other->second, attribute_tuples_);
        } else {
            return false;
        }
        return true;
    }

    // What counts: the frame, one text SPACE as 3D Slicer writes it, and an array at the points.
    void read_field() {
        word();
        for (auto arrays = number<std::int64_t>(); arrays > 0; --arrays) {
            if (in_lower_case(std::string(next_word())) == "metadata") {
                word();
                skip_metadata();
            }
            const std::string name(word());
            if (name == "NULL_ARRAY") continue;
            const auto components = number<std::int64_t>(), tuples = number<std::int64_t>();
            const std::string type = keyword();
            if (name != "SPACE" || in_attributes_)
                take_array(type, components, tuples);
            else if (type == "string" && components == 1 && tuples == 1)
                read_space();
            else
                refuse("has a field SPACE that is no text", "one text, LPS or RAS");
        }
    }

    void read_space() {
        line();
        space_ = binary_ ? coded_text() : line();
        while (!space_.empty() && white.find(space_.back()) != std::string_view::npos) space_.pop_back();
        if (space_ != "LPS" && space_ != "RAS")
            refuse("has the SPACE '" + as_utf8(space_).substr(0, 40) + "'", "LPS or RAS");
    }

    // VTK's binary texts: the two highest bits of the first byte say how many more bytes the length has.
    std::string coded_text() {
        const auto byte = [&] {
            if (at_ == text_.size()) refuse("ends within a text");
            return static_cast<unsigned char>(text_[at_++]);
        };
        const unsigned first = byte();
        constexpr std::array<int, 4> more{7, 3, 1, 0};
        std::uint64_t length = first & 0x3FU;
        for (int n = 0; n < more[first >> 6U]; ++n) length = length << 8U | byte();
        if (length > text_.size() - at_) refuse("ends within a text");
        at_ += length;
        return text_.substr(at_ - length, length);
    }

    // An array at the points becomes the voxels if it is the first; others are passed over.
    void take_array(const std::string& type, std::int64_t components, std::int64_t tuples) {
        components_ = components;
        if (!at_points_ || ++arrays_at_points_ > 1) return skip_values(type, components, tuples);
        if (components != 1) refuse("has several values to a point", "one");
        check_size({image_.grid.size[0], image_.grid.size[1], image_.grid.size[2]}, path_);
        if (tuples != static_cast<std::int64_t>(image_.grid.voxel_count()))
            refuse(fmt::format("has {} values at its points", tuples),
                   fmt::format("{}, as its dimensions say", image_.grid.voxel_count()));
        read_voxels(type);
    }

    void skip_values(const std::string& type, std::int64_t components, std::int64_t tuples) {
        const auto most = static_cast<std::int64_t>(8 * text_.size());  // there are bits
        if (components < 0 || tuples < 0 || (components > 0 && tuples > most / components))
            refuse("announces more values than the file has room for");
        const std::int64_t count = components * tuples;
        if (type == "string" || type == "utf8_string") {
            line();
            for (std::int64_t n = 0; n < count; ++n) {
                if (at_ == text_.size()) refuse("ends within its texts");
                binary_ ? static_cast<void>(coded_text()) : static_cast<void>(line());
            }
            return;
        }
        const std::size_t bits = bits_of(type);
        if (!binary_) {
            for (std::int64_t n = 0; n < count; ++n) word();
            return;
        }
        line();
        const std::size_t bytes = (static_cast<std::size_t>(count) * bits + 7) / 8;
        if (bytes > text_.size() - at_) refuse("announces more values than the file has room for");
        at_ += bytes;
    }

    std::size_t bits_of(const std::string& type) const {
        constexpr std::array<std::pair<std::string_view, std::size_t>, 16> sizes{{{"bit", 1},
                                                                                  {"char", 8},
                                                                                  {"signed_char", 8},
                                                                                  {"unsigned_char", 8},
                                                                                  {"short", 16},
                                                                                  {"unsigned_short", 16},
                                                                                  {"int", 32},
                                                                                  {"unsigned_int", 32},
                                                                                  {"vtkidtype", 32},
                                                                                  {"float", 32},
                                                                                  {"long", 64},
                                                                                  {"unsigned_long", 64},
                                                                                  {"vtktypeint64", 64},
                                                                                  {"vtktypeuint64", 64},
                                                                                  {"double", 64},
                                                                                  {"a fraction", 0}}};
        for (const auto& [name, bits] : sizes)
            if (name == type) return bits;
        refuse("holds " + as_utf8(type).substr(0, 40), "integers or real numbers");
    }

    // Up to an empty line, but names of components may be empty too.
    void skip_metadata() {
        line();
        while (at_ < text_.size()) {
            const std::string_view found = line();
            if (found.find_first_not_of(white) == std::string_view::npos) return;
            if (in_lower_case(std::string(found.substr(0, 15))) != "component_names") continue;
            for (std::int64_t n = 0; n < components_ && at_ < text_.size(); ++n) line();
        }
    }

    void read_scalars(const std::string& section, const NoteSink& note) {
        std::string type = "unsigned_char";
        std::int64_t components = 1;
        if (section == "scalars") {
            type = keyword();
            if (in_lower_case(std::string(next_word())) != "lookup_table")
                components = number<std::int64_t>();
            if (keyword() != "lookup_table") refuse("has scalars without LOOKUP_TABLE");
            word();
        } else {  // VTK writes unsigned char so, and in ASCII as fractions of 255
            components = number<std::int64_t>();
            if (!binary_) type = "a fraction";
        }
        if (at_points_ && scalars_at_points_) {  // of which VTK takes the first, too
            if (note) note("further scalars at the points are passed over");
            return skip_values(type, components_ = components, attribute_tuples_);
        }
        scalars_at_points_ = at_points_;
        take_array(type, components, attribute_tuples_);
    }

    void read_voxels(const std::string& type) {
        if (type == "a fraction") return read_fractions();
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

    void read_fractions() {
        read_values<float>();
        const auto& fractions = std::get<std::vector<float>>(image_.voxels);
        std::vector<std::uint8_t> voxels(fractions.size());
        std::ranges::transform(fractions, voxels.begin(), [&](float x) {
            if (!(x >= 0 && x <= 1)) refuse(fmt::format("has a colour of {}", x), "0 to 1");
            return static_cast<std::uint8_t>(std::lround(255 * x));
        });
        image_.voxels = std::move(voxels);
    }

    template <typename Voxel>
    void read_values() {
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

    // Which stays; empty at the end.
    std::string_view next_word() {
        left();
        return std::string_view(text_).substr(at_,
                                              std::min(text_.find_first_of(white, at_), text_.size()) - at_);
    }

    std::string_view word() {
        const std::string_view found = next_word();
        if (found.empty()) refuse("holds fewer voxels than its header claims");
        at_ += found.size();
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
    bool binary_ = false, in_attributes_ = false, at_points_ = false, scalars_at_points_ = false;
    std::int64_t attribute_tuples_ = 0, components_ = 1, arrays_at_points_ = 0;
    Eigen::Vector3d origin_ = Eigen::Vector3d::Zero(), spacing_ = Eigen::Vector3d::Ones(),
                    first_ = Eigen::Vector3d::Zero();  // voxel indices
    StoredImage image_;
};

}  // namespace

StoredImage read_legacy_vtk(const std::filesystem::path& path, const NoteSink& note) {
    return LegacyImage(path).read(note);
}

}  // namespace palpate::imaging
