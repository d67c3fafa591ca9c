// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "formats/model/label_map.hpp"
#include "formats/model/tet_mesh.hpp"

namespace palpate::report {

/// Draws a label map, on its volume if there is one: three orthogonal slices through all structures, then
/// through each of the first eight, with outlines in their colours, a scale bar in each slice and a legend of
/// all with their volumes; a PNG file's bytes. Precondition: a label occurs (asserted). Needs no display.
std::string label_preview_png(const LabelMap& map, const Volume* volume);

/// Draws a mesh from two sides and cut open from two, with regions in their colours, edges, scale bars and a
/// legend; a PNG file's bytes. Needs an X display (VirtualDisplay).
std::string mesh_preview_png(const TetMesh& mesh);

}  // namespace palpate::report
