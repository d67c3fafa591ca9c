// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/gravity/posture.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "formats/elasticity/discretisation.hpp"
#include "formats/elasticity/sound_tetrahedra.hpp"
#include "formats/model/errors.hpp"
#include "formats/model/label_map.hpp"
#include "formats/records/posture.hpp"
#include "tools/fem/solvers/free_system.hpp"

namespace palpate::fem {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double standard_gravity = 9.81;  // N/kg
constexpr double mm3_per_m3 = 1e9;
constexpr double corner_share_of_10 = -0.05;  // of an element's weight
constexpr double middle_share_of_10 = 0.2;

// "0,0.5,-0.9"; zero if it is none.
Vector3d direction_from(const std::string& text) {
    Vector3d direction;
    const char* at = text.data();
    const char* const end = at + text.size();
    for (Index axis = 0; axis < 3; ++axis) {
        const auto read = std::from_chars(at, end, direction[axis]);
        const bool last = axis == 2;
        if (read.ec != std::errc() || (last ? read.ptr != end : read.ptr == end || *read.ptr != ','))
            return Vector3d::Zero();
        at = read.ptr + (last ? 0 : 1);
    }
    return direction;
}

std::string name_of(const std::vector<Label>& names, std::int32_t value) {
    const auto found = std::ranges::find(names, value, &Label::value);
    return found == names.end() ? std::to_string(value) : found->name;
}

// By region of each tetrahedron, kg/mm³.
std::vector<double> density_of_tetrahedra(const TetMesh& mesh, std::span<const RegionDensity> densities) {
    std::vector<double> result;
    for (const std::int32_t region : mesh.regions) {
        const auto found = std::ranges::find(densities, region, &RegionDensity::region);
        if (found == densities.end())
            throw InvalidInput({"region '" + name_of(mesh.region_names, region) + "'", "has no density",
                                "one of every region where a posture is named",
                                "add density_kg_m3 to it in the case file, or --density"});
        result.push_back(found->density / mm3_per_m3);
    }
    return result;
}

}  // namespace

Vector3d gravity_in(const std::string& posture, const std::string& culprit) {
    for (const auto& [name, down] : named_postures)
        if (posture == name) return standard_gravity * Vector3d(down[0], down[1], down[2]);
    const Vector3d direction = direction_from(posture);
    if (!direction.allFinite() || direction.isZero(0))
        throw UsageError({culprit + " " + posture, "is no posture", posture_grammar, ""});
    return standard_gravity * direction.normalized();
}

std::vector<Vector3d> displacements_under(const DeformableBody& body,
                                          std::span<const RegionDensity> densities, const Vector3d& change) {
    const std::vector<double> density = density_of_tetrahedra(body.mesh, densities);
    const elasticity::Discretisation discretisation = elasticity::discretise(body);
    const FreeSystem system = assemble_free_system(body, NodeOrder::nested_dissection);
    Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(system.stiffness.rows(), 1);
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
        const Vector3d weight = density[t] * six_volume(body.mesh, t) / 6 * change;
        const auto nodes = elasticity::nodes_of_element(discretisation, t);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const double share = nodes.size() == 4 ? 0.25 : i < 4 ? corner_share_of_10 : middle_share_of_10;
            const std::int32_t position = system.position_of_node[static_cast<std::size_t>(nodes[i])];
            if (position >= 0) loads.block<3, 1>(3 * Index{position}, 0) += share * weight;
        }
    }
    const Eigen::MatrixXd solution = factorise(body, system, Elimination::as_given).solve(loads);
    std::vector<Vector3d> displacements;
    for (std::size_t node = 0; node < body.mesh.rest_positions.size(); ++node) {
        const std::int32_t position = system.position_of_node[node];
        displacements.push_back(position < 0 ? Vector3d::Zero()
                                             : Vector3d(solution.block<3, 1>(3 * Index{position}, 0)));
    }
    return displacements;
}

Sag move_at_rest(DeformableBody& body, std::span<const Vector3d> displacements) {
    Sag sag;
    for (const Vector3d& u : displacements)
        sag.largest_displacement = std::max(sag.largest_displacement, u.norm());
    const std::vector<Vector3d> before = body.mesh.rest_positions;
    for (std::size_t node = 0; node < before.size(); ++node)
        body.mesh.rest_positions[node] += displacements[node];
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
        if (!(elasticity::element_quality(body.mesh, t) > elasticity::smallest_element_quality))
            throw InvalidInput(
                {fmt::format("tetrahedron {} of '{}'", t, body.name),
                 fmt::format("turns over in the new posture, where the body sags by up to {:.0f} mm",
                             sag.largest_displacement),
                 "a shape that linear tissue can have",
                 "check moduli and densities, or hold more nodes by 'fixed'"});
        for (const auto& [a, b] : elasticity::tetrahedron_edges) {
            const auto first = static_cast<std::size_t>(body.mesh.tetrahedra[t][a]);
            const auto second = static_cast<std::size_t>(body.mesh.tetrahedra[t][b]);
            const double length = (before[second] - before[first]).norm();
            const double now = (body.mesh.rest_positions[second] - body.mesh.rest_positions[first]).norm();
            sag.largest_stretch = std::max(sag.largest_stretch, std::abs(now / length - 1));
        }
    }
    body.boundary = boundary_surface(body.mesh);
    return sag;
}

}  // namespace palpate::fem
