// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/ellipsoid.hpp"

#include <algorithm>
#include <iterator>
#include <set>

namespace palpate::experiments {

DeformableBody held_body(TetMesh mesh, const fem::NodeRule& rule) {
    DeformableBody body;
    body.name = "body";
    body.mesh = std::move(mesh);
    for (const std::int32_t region : std::set(body.mesh.regions.begin(), body.mesh.regions.end()))
        body.materials.push_back({region, {3e-3, 0.45}});
    body.boundary = boundary_surface(body.mesh);
    body.fixed_nodes = fem::fixed_nodes_of(body.mesh, body.boundary, {&rule, 1});
    std::ranges::set_difference(body.boundary.nodes, body.fixed_nodes,
                                std::back_inserter(body.contact_nodes));
    return body;
}

}  // namespace palpate::experiments
