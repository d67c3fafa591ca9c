// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "formats/model/tet_mesh.hpp"
#include "tools/report/pictures/scene.hpp"
#include "tools/report/quality.hpp"

namespace palpate::report {

/// Shows a picture of the scene as inline SVG: letters in a corner say which of the patient's sides face the
/// reader (R or L, A or P, S or I), and the marks are ringed with their names beside them.
std::string view_svg(const SceneView& view, const ViewDirection& direction, const std::string& description,
                     const std::vector<std::string>& mark_names = {});

/// Draws one tetrahedron from where it looks widest, hidden edges dashed, with its six dihedral angles at its
/// edges; the sharpest and the bluntest stand out.
std::string tetrahedron_svg(const TetMesh& mesh, std::size_t t, const Label& region);

}  // namespace palpate::report
