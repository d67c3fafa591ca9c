// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/fem/analytic/elastic_system.hpp"

#include <Eigen/CholmodSupport>
#include <Eigen/Geometry>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace palpate::test {
namespace {

// Adds a force per area to the nodes of the faces on which all corners satisfy `condition`.
Eigen::VectorXd face_forces(const ElasticSystem& system, const Condition& condition,
                            const std::function<Eigen::Vector3d(const Eigen::Vector3d& area)>& force_on) {
    std::map<std::array<std::int32_t, 2>, std::int32_t> middle;
    for (std::size_t i = 0; i < system.discretisation.edges.size(); ++i) {
        auto ends = system.discretisation.edges[i];
        if (ends[0] > ends[1]) std::swap(ends[0], ends[1]);
        middle[ends] = static_cast<std::int32_t>(system.body.mesh.rest_positions.size() + i);
    }
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(system.dof_count());
    const BoundarySurface boundary = boundary_surface(system.body.mesh);
    for (const Triangle& triangle : boundary.surface.triangles) {
        std::array<std::int32_t, 3> nodes;
        for (std::size_t c = 0; c < 3; ++c) nodes[c] = boundary.nodes[static_cast<std::size_t>(triangle[c])];
        const auto at = [&](std::size_t c) { return system.positions[static_cast<std::size_t>(nodes[c])]; };
        if (!condition(at(0)) || !condition(at(1)) || !condition(at(2))) continue;
        const Eigen::Vector3d area = (at(1) - at(0)).cross(at(2) - at(0)) / 2;  // outwards
        for (std::size_t c = 0; c < 3; ++c) {
            std::int32_t node = nodes[c];
            if (!middle.empty())
                node = middle.at(
                    {std::min(nodes[c], nodes[(c + 1) % 3]), std::max(nodes[c], nodes[(c + 1) % 3])});
            forces.segment<3>(3 * node) += force_on(area) / 3;
        }
    }
    return forces;
}

}  // namespace

ElasticSystem elastic_system(TetMesh mesh, const Material& material, ElementOrder order) {
    DeformableBody body;
    body.name = "body";
    body.mesh = std::move(mesh);
    body.materials = {{1, material}};
    body.element_order = order;
    return elastic_system(std::move(body));
}

ElasticSystem elastic_system(DeformableBody body) {
    ElasticSystem system;
    system.discretisation = elasticity::discretise(body);
    system.positions = body.mesh.rest_positions;
    for (const auto& [a, b] : system.discretisation.edges)
        system.positions.push_back(
            (system.positions[static_cast<std::size_t>(a)] + system.positions[static_cast<std::size_t>(b)]) /
            2);
    std::vector<std::int32_t> all(system.positions.size());
    std::iota(all.begin(), all.end(), 0);
    system.stiffness = elasticity::assemble_stiffness(body.mesh, body.materials, system.discretisation, all);
    system.body = std::move(body);
    return system;
}

Supports::Supports(const ElasticSystem& system)
    : held(static_cast<std::size_t>(system.dof_count())), values(Eigen::VectorXd::Zero(system.dof_count())) {}

void Supports::hold(const ElasticSystem& system, int component, const Condition& condition, double value) {
    for (std::size_t node = 0; node < system.positions.size(); ++node)
        if (condition(system.positions[node])) {
            const std::size_t dof = 3 * node + static_cast<std::size_t>(component);
            held[dof] = true;
            values[static_cast<Eigen::Index>(dof)] = value;
        }
}

void Supports::impose(const ElasticSystem& system, const Condition& condition, const VectorField& field) {
    for (std::size_t node = 0; node < system.positions.size(); ++node)
        if (condition(system.positions[node])) {
            for (std::size_t c = 0; c < 3; ++c) held[3 * node + c] = true;
            values.segment<3>(static_cast<Eigen::Index>(3 * node)) = field(system.positions[node]);
        }
}

Eigen::MatrixXd solve(const ElasticSystem& system, const Supports& supports, const Eigen::MatrixXd& forces) {
    std::vector<Eigen::Index> position(supports.held.size(), -1), free;
    Eigen::VectorXd known = Eigen::VectorXd::Zero(system.dof_count());
    for (std::size_t dof = 0; dof < position.size(); ++dof) {
        const auto at = static_cast<Eigen::Index>(dof);
        if (supports.held[dof]) {
            known[at] = supports.values[at];
        } else {
            position[dof] = static_cast<Eigen::Index>(free.size());
            free.push_back(at);
        }
    }
    std::vector<Eigen::Triplet<double, std::int64_t>> entries;
    entries.reserve(static_cast<std::size_t>(system.stiffness.nonZeros()));
    for (Eigen::Index column = 0; column < system.stiffness.outerSize(); ++column)
        for (elasticity::LowerSparse::InnerIterator entry(system.stiffness, column); entry; ++entry) {
            const Eigen::Index i = position[static_cast<std::size_t>(entry.row())];
            const Eigen::Index j = position[static_cast<std::size_t>(column)];
            if (i >= 0 && j >= 0) entries.emplace_back(i, j, entry.value());
        }
    const auto size = static_cast<Eigen::Index>(free.size());
    elasticity::LowerSparse K(size, size);
    K.setFromTriplets(entries.begin(), entries.end());
    const Eigen::CholmodSupernodalLLT<elasticity::LowerSparse, Eigen::Lower> factor(K);
    if (factor.info() != Eigen::Success) throw std::runtime_error("the supports leave the body loose");

    const Eigen::MatrixXd right = forces.colwise() - nodal_forces(system, known);
    const Eigen::MatrixXd right_free = right(free, Eigen::all);
    const Eigen::MatrixXd u_free = factor.solve(right_free);
    Eigen::MatrixXd u = known.replicate(1, forces.cols());
    u(free, Eigen::all) = u_free;
    return u;
}

Eigen::VectorXd solve(const ElasticSystem& system, const Supports& supports) {
    return solve(system, supports, Eigen::MatrixXd(Eigen::MatrixXd::Zero(system.dof_count(), 1)));
}

Eigen::VectorXd nodal_forces(const ElasticSystem& system, const Eigen::VectorXd& displacements) {
    return system.stiffness.selfadjointView<Eigen::Lower>() * displacements;
}

Eigen::VectorXd pressure_forces(const ElasticSystem& system, const Condition& condition, double pressure) {
    return face_forces(system, condition,
                       [&](const Eigen::Vector3d& area) { return Eigen::Vector3d(-pressure * area); });
}

Eigen::VectorXd traction_forces(const ElasticSystem& system, const Condition& condition,
                                const Eigen::Vector3d& traction) {
    return face_forces(system, condition,
                       [&](const Eigen::Vector3d& area) { return Eigen::Vector3d(area.norm() * traction); });
}

Eigen::VectorXd body_forces(const ElasticSystem& system, const Eigen::Vector3d& per_volume) {
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(system.dof_count());
    const auto per_element = static_cast<std::size_t>(system.discretisation.nodes_per_element);
    for (std::size_t t = 0; t < system.body.mesh.tetrahedra.size(); ++t)
        for (std::size_t a = 0; a < per_element; ++a) {
            const double share = per_element == 4 ? 1.0 / 4 : (a < 4 ? -1.0 / 20 : 1.0 / 5);
            forces.segment<3>(3 * system.discretisation.elements[per_element * t + a]) +=
                share * six_volume(system.body.mesh, t) / 6 * per_volume;
        }
    return forces;
}

}  // namespace palpate::test
