// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

namespace palpate::meshing {

/// Checks what a legacy VTK file announces of arrays (SCALARS, COLOR_SCALARS, TEXTURE_COORDINATES,
/// LOOKUP_TABLE, FIELD and the arrays of that), because VTK allocates it before it reads any: no more values
/// than the file has bytes, and at most 64 to a point or cell. Throws InvalidInput naming the file. Cost:
/// linear.
void require_room_for_arrays(const std::filesystem::path& path);

}  // namespace palpate::meshing
