// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::stl_file {

using Corner = std::array<float, 3>;  ///< mm

/// Whether a file's bytes are binary STL: of the size that they announce, or no text that begins with
/// "solid".
bool is_binary(std::string_view bytes);

/// The corners of all triangles, three each, of binary STL. Throws InvalidInput naming `file` if it is
/// shorter or longer than it announces, or a corner is not finite or too far away, and likewise below.
std::vector<Corner> binary_corners(std::string_view bytes, const std::string& file);

/// The same of ASCII STL: facets of three vertices in one solid or several; words in any case, lines broken
/// anywhere but behind a solid's name.
std::vector<Corner> ascii_corners(std::string_view text, const std::string& file);

}  // namespace palpate::stl_file
