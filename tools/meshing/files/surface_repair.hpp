// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <string_view>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::meshing {

/// Makes a surface the boundary of a body or refuses it: closed, manifold, all triangles facing outwards.
///
/// Repaired, with a note each: triangles with a repeated vertex (left out), unused vertices (left out),
/// pieces that touch in a point (its vertex is doubled), triangles against the majority of their piece, and
/// pieces that face inwards and lie in no other piece's box, as a cavity would (turned). Throws InvalidInput
/// naming `culprit`, the number and the place of: open edges, edges of more than two triangles, triangles
/// without area, a one-sided piece. A sound surface comes back as it is. Self-intersections are not looked
/// for. Cost: O(n log n).
TriangleMesh repaired_surface(TriangleMesh surface, const std::string& culprit,
                              const std::function<void(std::string_view)>& note = {});

/// Throws InvalidInput, naming `culprit`, unless repaired_surface() would return the surface as it is.
void require_sound_surface(const TriangleMesh& surface, const std::string& culprit);

}  // namespace palpate::meshing
