// SPDX-License-Identifier: Apache-2.0
#include "formats/stl_file/read_stl.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string>

#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"
#include "formats/stl_file/closed_surface.hpp"
#include "formats/stl_file/facets.hpp"

namespace palpate::stl_file {
namespace {

constexpr std::uintmax_t most_bytes = 84 + 50 * (std::uintmax_t{1} << 20);

// No more than it may have, even if it grows meanwhile.
std::string bytes_of(const std::filesystem::path& path) {
    require_small_file(path, most_bytes);
    std::error_code absent;
    const std::uintmax_t size = std::filesystem::file_size(path, absent);
    std::ifstream stream(path, std::ios::binary);
    if (absent || !stream) throw InvalidInput({path.string(), "cannot be read", "", "check the path"});
    std::string bytes(std::min(size, most_bytes), '\0');
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(stream.gcount()));
    return bytes;
}

}  // namespace

TriangleMesh read_stl(const std::filesystem::path& path) {
    const std::string bytes = bytes_of(path), file = path.string();
    return closed_surface(is_binary(bytes) ? binary_corners(bytes, file) : ascii_corners(bytes, file), file);
}

}  // namespace palpate::stl_file
