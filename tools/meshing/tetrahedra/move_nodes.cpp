// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/tetrahedra/move_nodes.hpp"

#include <algorithm>
#include <vector>

#include "tools/meshing/measures/quality.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"

namespace palpate::meshing {
namespace {

// The nodes of tetrahedra flatter than `lowest`, by tetrahedron, allows.
std::vector<std::int32_t> nodes_of_flat_ones(const TetMesh& mesh, const std::vector<double>& lowest) {
    std::vector<std::int32_t> nodes;
    for (std::size_t t = 0; t < lowest.size(); ++t)
        if (!(six_volume(mesh, t) > 0) || flatness_deg(mesh, t) < lowest[t])
            nodes.insert(nodes.end(), mesh.tetrahedra[t].begin(), mesh.tetrahedra[t].end());
    return nodes;
}

std::vector<std::int32_t> nodes_of_cuts(const TetMesh& mesh) {
    const BoundarySurface boundary = boundary_surface(mesh);
    std::vector<std::int32_t> nodes;
    for (const auto& pair : self_intersections(boundary.surface))
        for (const std::size_t t : pair)
            for (const std::int32_t v : boundary.surface.triangles[t])
                nodes.push_back(boundary.nodes[static_cast<std::size_t>(v)]);
    return nodes;
}

}  // namespace

void move_nodes(TetMesh& mesh, const Eigen::VectorXd& step, double floor_deg) {
    const std::vector<Eigen::Vector3d> before = mesh.rest_positions;
    std::vector<double> lowest(mesh.tetrahedra.size()), fraction(before.size(), 1.0);
    for (std::size_t t = 0; t < lowest.size(); ++t) lowest[t] = std::min(floor_deg, flatness_deg(mesh, t));
    constexpr int halvings = 8, max_rounds = 100;  // then nodes stay, and those around them may have to
    for (int round = 0; round < max_rounds; ++round) {
        for (std::size_t node = 0; node < before.size(); ++node)
            mesh.rest_positions[node] =
                before[node] + fraction[node] * step.segment<3>(3 * static_cast<Eigen::Index>(node));
        std::vector<std::int32_t> wrong = nodes_of_flat_ones(mesh, lowest);
        if (wrong.empty()) wrong = nodes_of_cuts(mesh);
        if (wrong.empty()) return;
        std::ranges::sort(wrong);
        wrong.erase(std::ranges::unique(wrong).begin(), wrong.end());
        for (const std::int32_t node : wrong) fraction[node] = round < halvings ? 0.5 * fraction[node] : 0;
    }
    mesh.rest_positions = before;
}

}  // namespace palpate::meshing
