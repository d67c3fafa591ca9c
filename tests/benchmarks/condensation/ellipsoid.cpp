// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/benchmarks/condensation/ellipsoid.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include "tools/fem/boundary_conditions.hpp"

namespace palpate {

DeformableBody held_ellipsoid(TetMesh mesh) {
    // Beyond this height lies a tenth of the ellipsoid's area.
    constexpr double height = 42;  // mm
    DeformableBody body;
    body.name = "ellipsoid";
    body.mesh = std::move(mesh);
    for (const std::int32_t region : std::set(body.mesh.regions.begin(), body.mesh.regions.end()))
        body.materials.push_back({region, {3e-3, 0.45}});
    body.boundary = boundary_surface(body.mesh);
    const FixedRule held = BeyondPlane{{0, 0, height}, {0, 0, 1}};
    body.fixed_nodes = fixed_nodes_of(body.mesh, body.boundary, {&held, 1});
    std::ranges::set_difference(body.boundary.nodes, body.fixed_nodes,
                                std::back_inserter(body.contact_nodes));
    return body;
}

}  // namespace palpate
