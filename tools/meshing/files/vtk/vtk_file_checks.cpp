// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/files/vtk/vtk_file_checks.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>

#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"
#include "tools/meshing/files/scanner.hpp"
#include "tools/meshing/files/text.hpp"
#include "tools/meshing/files/vtk/legacy_arrays.hpp"

namespace palpate::meshing {
namespace {

// Sizes in binary files; eight values of type bit take one byte.
const std::map<std::string, std::size_t> type_sizes{
    {"bit", 1},           {"char", 1},           {"signed_char", 1},   {"unsigned_char", 1},
    {"short", 2},         {"unsigned_short", 2}, {"int", 4},           {"unsigned_int", 4},
    {"vtkidtype", 4},     {"long", 8},           {"unsigned_long", 8}, {"vtktypeint64", 8},
    {"vtktypeuint64", 8}, {"float", 4},          {"double", 8}};

constexpr std::array<std::string_view, 11> sections{"points",   "cells",           "polygons",   "lines",
                                                    "vertices", "triangle_strips", "cell_types", "field",
                                                    "metadata", "cell_data",       "point_data"};

// Those whose next word is a name, which may be a keyword.
const std::set<std::string> named_attributes{
    "scalars",       "vectors",    "normals",      "tensors",    "tensors6",    "texture_coordinates",
    "color_scalars", "global_ids", "pedigree_ids", "edge_flags", "lookup_table"};

class LegacyCheck {
  public:
    explicit LegacyCheck(const std::filesystem::path& path) : file_(path) {}

    void run() {
        file_.line();  // version
        file_.line();  // title
        binary_ = lower_case(file_.word()) == "binary";
        std::int64_t points = 0, cells = 0, types = 0;
        std::set<std::string> seen;
        while (!file_.at_end()) {
            const std::string keyword = lower_case(file_.word());
            require_whole_name(keyword);
            if (keyword == "field") check_fields();
            if (keyword == "metadata") skip_metadata(1);
            if (keyword == "cell_data" || keyword == "point_data") in_attributes_ = true;
            if (in_attributes_) {
                if (named_attributes.contains(keyword)) file_.word();
                continue;
            }
            const bool of_cells = keyword == "cells" || keyword == "polygons" || keyword == "lines" ||
                                  keyword == "vertices" || keyword == "triangle_strips";
            if (!of_cells && keyword != "points" && keyword != "cell_types") continue;
            if (!seen.insert(keyword).second) file_.fail("a second section " + keyword, "one", again);
            const std::int64_t count = file_.require_room(file_.integer(), 1);
            if (keyword == "points") {
                skip_values(3 * (points = count), lower_case(file_.word()));
                skip_metadata_after(3);
            } else if (keyword == "cell_types")
                skip_values(types = count, "int");
            else if (const std::int64_t found = check_cells(count); keyword == "cells")
                cells = found;
        }
        if (cells != types)
            file_.fail(fmt::format("{} cells, but {} cell types", cells, types), "as many", again);
        if (lowest_corner_ < 0 || highest_corner_ >= points)
            file_.fail(
                fmt::format("a cell names point {}", lowest_corner_ < 0 ? lowest_corner_ : highest_corner_),
                fmt::format("0 ... {} - 1", points), again);
    }

  private:
    std::size_t size_of(const std::string& type) const {
        const auto found = type_sizes.find(lower_case(type));
        if (found == type_sizes.end())
            file_.fail(fmt::format("values of type '{}'", type.substr(0, 40)), "such as float or int", again);
        return found->second;
    }

    // VTK looks at how a section's name begins, and reads what follows.
    void require_whole_name(const std::string& keyword) const {
        for (const std::string_view name : sections)
            if (keyword.starts_with(name) && keyword != name)
                file_.fail(fmt::format("a section '{}'", keyword.substr(0, 40)), std::string(name), again);
    }

    // VTK's readers use what is not there where an array of a field breaks off, and allocate what a text
    // announces.
    void check_fields() {
        file_.word();  // its name
        for (std::int64_t left = file_.require_room(file_.integer(), 1); left > 0; --left) {
            if (file_.word() == "NULL_ARRAY") continue;
            const std::int64_t components = file_.integer(), tuples = file_.integer();
            const auto most = static_cast<std::int64_t>(8 * file_.text().size());  // there are bits
            if (components < 0 || tuples < 0 || (components > 0 && tuples > most / components))
                file_.fail(
                    fmt::format("{} times {} values, for which the file is too short", tuples, components),
                    "", again);
            const std::string type = lower_case(file_.word());
            if (type == "string" || type == "utf8_string")
                skip_texts(components * tuples);
            else
                skip_values(components * tuples, type);
            skip_metadata_after(components);
        }
    }

    void skip_texts(std::int64_t count) {
        file_.line();
        for (std::int64_t n = file_.require_room(count, 1); n > 0; --n)
            binary_ ? skip_binary_text() : static_cast<void>(file_.line());
    }

    // The two highest bits of the first byte say how many more bytes the length has.
    void skip_binary_text() {
        const unsigned first = file_.raw<std::uint8_t>();
        constexpr std::array<int, 4> more{7, 3, 1, 0};
        std::uint64_t length = first & 0x3FU;
        for (int n = 0; n < more[first >> 6U]; ++n) length = length << 8U | file_.raw<std::uint8_t>();
        file_.skip(static_cast<std::int64_t>(length), 1);
    }

    void skip_metadata_after(std::int64_t components) {
        if (lower_case(file_.peek().substr(0, 8)) != "metadata") return;
        file_.word();
        skip_metadata(components);
    }

    // Up to an empty line, but names of components may be empty too.
    void skip_metadata(std::int64_t components) {
        file_.line();
        while (!file_.exhausted()) {
            const std::string_view line = file_.line();
            if (line.find_first_not_of(" \t\r") == std::string_view::npos) return;
            if (lower_case(line.substr(0, 15)) != "component_names") continue;
            for (std::int64_t n = 0; n < components && !file_.exhausted(); ++n) file_.line();
        }
    }

    void begin_values() {
        if (binary_) file_.line();
    }

    void skip_values(std::int64_t count, const std::string& type) {
        const std::size_t size = size_of(type);
        begin_values();
        if (binary_) return type == "bit" ? file_.skip((count + 7) / 8, 1) : file_.skip(count, size);
        for (std::int64_t left = file_.require_room(count, 1); left > 0; --left) file_.number();
    }

    std::int64_t integer(std::size_t size) {
        if (!binary_) return file_.integer();
        return size == 8 ? file_.raw<std::int64_t>(std::endian::big)
                         : file_.raw<std::int32_t>(std::endian::big);
    }

    void take_corner(std::size_t bytes) {
        const std::int64_t corner = integer(bytes);
        lowest_corner_ = std::min(lowest_corner_, corner);
        highest_corner_ = std::max(highest_corner_, corner);
    }

    // Returns the number of cells.
    std::int64_t check_cells(std::int64_t count) {
        const std::int64_t size = file_.require_room(file_.integer(), 1);
        begin_values();
        if (lower_case(file_.peek().substr(0, 8)) == "offsets") return check_offsets(count, size);
        std::int64_t left = size;
        for (std::int64_t cell = 0; cell < count; ++cell) {
            const std::int64_t corners = left > 0 ? integer(4) : 0;
            if (left <= 0 || corners < 0 || corners >= left)
                file_.fail(fmt::format("{} cells that do not fit into {} numbers", count, size), "", again);
            for (std::int64_t c = 0; c < corners; ++c) take_corner(4);
            left -= corners + 1;
        }
        if (left != 0)
            file_.fail(fmt::format("{} numbers, of which the cells use {}", size, size - left), "all", again);
        return count;
    }

    // Version 5.1: where each cell begins, and the end of the last one.
    std::int64_t check_offsets(std::int64_t count, std::int64_t size) {
        file_.word();
        const std::size_t bytes = size_of(std::string(file_.word()));
        begin_values();
        std::int64_t last = 0;
        for (std::int64_t n = 0; n < count; ++n) {
            const std::int64_t offset = integer(bytes);
            if (offset < last || (n == 0 && offset != 0)) file_.fail("offsets that do not rise", "", again);
            last = offset;
        }
        skip_metadata_after(1);
        if (last != size)
            file_.fail(fmt::format("offsets that end at {}", last), fmt::format("{}", size), again);
        if (lower_case(file_.word()) != "connectivity")
            file_.fail("no CONNECTIVITY after OFFSETS", "", again);
        const std::size_t corner_bytes = size_of(std::string(file_.word()));
        begin_values();
        for (std::int64_t c = 0; c < size; ++c) take_corner(corner_bytes);
        return std::max<std::int64_t>(count - 1, 0);
    }

    static constexpr const char* again = "write the file again";
    Scanner file_;
    bool binary_ = false, in_attributes_ = false;
    std::int64_t lowest_corner_ = 0, highest_corner_ = -1;
};

// Reading from a pipe or a device may have no end.
void require_file(const std::filesystem::path& path) {
    if (const std::string kind = other_kind(path); !kind.empty())
        throw InvalidInput({path.string(), kind, "a file", "check the path"});
}

}  // namespace

std::size_t require_plausible_xml(const std::filesystem::path& path) {
    require_file(path);
    std::ifstream stream(path, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    const std::string_view header = std::string_view(text).substr(0, text.find("<AppendedData"));
    // By how much compression shrinks at most: zlib 1032, LZ4 255, LZMA 7000, all of equal bytes.
    const bool packed = header.find("compressor") != std::string::npos;
    const bool lzma = header.find("LZMA") != std::string::npos;
    const std::size_t room = text.size() * (lzma ? 7000 : packed ? 1100 : 1);
    for (std::size_t at = header.find("NumberOf"); at != std::string::npos;
         at = header.find("NumberOf", at + 1)) {
        const std::size_t equals = header.find('=', at), open = header.find_first_of("\"'", equals);
        if (open == std::string::npos) break;
        const std::string_view name = header.substr(at, equals - at);
        if (name.find_first_of("\"'<>") != std::string::npos) continue;  // an array's name
        const std::string_view value =
            header.substr(open + 1, header.find_first_of("\"'", open + 1) - open - 1);
        std::int64_t number = -1;
        const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
        const std::int64_t least = name.starts_with("NumberOfComponents") ? 1 : 0;
        // A point has three numbers of two bytes or more.
        const std::size_t most = room / (name.starts_with("NumberOfPoints") ? 6 : 1);
        if (error != std::errc{} || end != value.data() + value.size() || number < least ||
            static_cast<std::size_t>(number) > most)
            throw InvalidInput(
                {path.string(), fmt::format("{} is '{}'", name.substr(0, 40), value.substr(0, 40)),
                 fmt::format("{} or more, and no more than the file has room for", least), "write it again"});
    }
    return room;
}

void require_sound_legacy(const std::filesystem::path& path) {
    require_file(path);
    require_room_for_arrays(path);
    LegacyCheck(path).run();
}

}  // namespace palpate::meshing
