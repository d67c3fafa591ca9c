// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <filesystem>

namespace palpate::meshing {

/// Checks the NumberOf... attributes of a VTK XML file, because VTK's readers allocate what these say: whole
/// numbers that the file's size has room for, compressed or not. Throws InvalidInput naming the attribute.
/// What is no such file passes; reading it says so. Returns how many values the file may hold.
std::size_t require_plausible_xml(const std::filesystem::path& path);

/// Checks arrays (require_room_for_arrays()), points, cells and cell types of a legacy VTK file of
/// unstructured grid or polygons, because VTK's readers write past their arrays where the counts contradict
/// each other. Throws InvalidInput naming file and line. Source: VTK user's guide, "Simple legacy formats",
/// and version 5.1 of these.
void require_sound_legacy(const std::filesystem::path& path);

}  // namespace palpate::meshing
