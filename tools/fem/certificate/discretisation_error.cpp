// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/certificate/discretisation_error.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "formats/elasticity/discretisation.hpp"
#include "tools/fem/assembly/refinement.hpp"
#include "tools/fem/certificate/contact_loads.hpp"
#include "tools/fem/solvers/free_system.hpp"

namespace palpate::fem {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Tractions = std::vector<Vector3d>;  // at each mesh node, N/mm², linear between them on the surface

// Forces on the discretisation's nodes that do the same work as the tractions: integrals over each triangle
// of traction times shape function, by the integral of barycentric monomials, 2 A a! b! c! / (a + b + c +
// 2)!.
std::vector<Vector3d> consistent_forces(const DeformableBody& body,
                                        const elasticity::Discretisation& discretisation,
                                        const Tractions& tractions) {
    std::map<std::array<std::int32_t, 2>, std::size_t> middle_of;
    for (std::size_t e = 0; e < discretisation.edges.size(); ++e)
        middle_of[discretisation.edges[e]] = body.mesh.rest_positions.size() + e;
    std::vector<Vector3d> forces(discretisation.node_count, Vector3d::Zero());
    for (const Triangle& triangle : body.boundary.surface.triangles) {
        std::array<std::size_t, 3> node{};
        for (std::size_t c = 0; c < 3; ++c)
            node[c] = static_cast<std::size_t>(body.boundary.nodes[triangle[c]]);
        const auto p = [&](std::size_t c) { return body.mesh.rest_positions[node[c]]; };
        const double area = (p(1) - p(0)).cross(p(2) - p(0)).norm() / 2;
        const Vector3d sum = tractions[node[0]] + tractions[node[1]] + tractions[node[2]];
        for (std::size_t c = 0; c < 3; ++c) {
            const Vector3d& own = tractions[node[c]];
            if (discretisation.edges.empty()) {
                forces[node[c]] += area / 12 * (sum + own);
                continue;
            }
            // Corner function l (2 l - 1): 1/30 against its own l, -1/60 against the others, times A.
            forces[node[c]] += area / 60 * (3 * own - sum);
            // Middle function 4 l l': 2/15 against either of its ends' l, 1/15 against the third's, times A.
            const std::size_t next = node[(c + 1) % 3];
            const std::array edge{static_cast<std::int32_t>(std::min(node[c], next)),
                                  static_cast<std::int32_t>(std::max(node[c], next))};
            forces[middle_of.at(edge)] += area / 15 * (sum + own + tractions[next]);
        }
    }
    return forces;
}

// Work of each load on the displacement that it causes, N mm.
std::vector<double> works(const DeformableBody& body, const std::vector<Tractions>& loads) {
    const FreeSystem system = assemble_free_system(body, NodeOrder::nested_dissection);
    const elasticity::Discretisation discretisation = elasticity::discretise(body);
    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(system.stiffness.rows(), static_cast<Index>(loads.size()));
    for (std::size_t k = 0; k < loads.size(); ++k) {
        const std::vector<Vector3d> nodal = consistent_forces(body, discretisation, loads[k]);
        for (std::size_t node = 0; node < nodal.size(); ++node)
            if (const std::int32_t at = system.position_of_node[node]; at >= 0)
                forces.col(static_cast<Index>(k)).segment<3>(3 * Index{at}) = nodal[node];
    }
    const Eigen::MatrixXd u = factorise(body, system, Elimination::as_given).solve(forces);
    std::vector<double> result;
    for (Index k = 0; k < u.cols(); ++k) result.push_back(forces.col(k).dot(u.col(k)));
    return result;
}

// The body on richer elements, and the tractions at its mesh nodes.
DeformableBody enriched(const DeformableBody& body, std::vector<Tractions>& loads) {
    DeformableBody richer = body;
    richer.compliance = {};
    richer.element_order = ElementOrder::quadratic;
    if (body.element_order == ElementOrder::linear) return richer;
    const elasticity::Discretisation coarse = elasticity::discretise(body);
    richer.mesh = refine_uniformly(body.mesh);
    richer.boundary = boundary_surface(richer.mesh);
    richer.fixed_nodes = coarse.fixed_nodes;
    for (Tractions& load : loads)
        for (const auto& [a, b] : coarse.edges) load.push_back((load[a] + load[b]) / 2);
    return richer;
}

}  // namespace

double estimate_discretisation_error(const DeformableBody& body) {
    constexpr std::int32_t load_count = 63;
    constexpr std::uint64_t seed = 11;
    std::vector<Tractions> loads;
    for (const ContactLoad& contact : random_contact_loads(body, load_count, seed)) {
        Tractions tractions(body.mesh.rest_positions.size(), Vector3d::Zero());
        for (const NodeForce& force : contact)
            tractions[body.contact_nodes[force.node]] = force.force.cast<double>();
        loads.push_back(std::move(tractions));
    }
    const std::vector<double> own = works(body, loads);
    const DeformableBody richer_body = enriched(body, loads);
    const std::vector<double> richer = works(richer_body, loads);
    std::vector<double> missing;
    for (std::size_t k = 0; k < own.size(); ++k) missing.push_back(1 - own[k] / richer[k]);
    std::ranges::nth_element(missing, missing.begin() + load_count / 2);
    return missing[load_count / 2];
}

}  // namespace palpate::fem
