// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/certificate/contact_loads.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace palpate::fem {
std::vector<Eigen::Vector3d> contact_normals(const DeformableBody& body) {
    const std::vector<Eigen::Vector3d> of_vertex = surface_normals(body.boundary.surface);
    std::vector<Eigen::Vector3d> normals;
    for (const std::int32_t node : body.contact_nodes)
        normals.push_back(of_vertex[static_cast<std::size_t>(
            std::ranges::lower_bound(body.boundary.nodes, node) - body.boundary.nodes.begin())]);
    return normals;
}

std::vector<ContactLoad> random_contact_loads(const DeformableBody& body, std::int32_t count,
                                              std::uint64_t seed) {
    const std::vector<Eigen::Vector3d> normals = contact_normals(body);
    const auto point = [&](std::int32_t contact) {
        return body.mesh.rest_positions[body.contact_nodes[contact]];
    };
    std::mt19937_64 random(seed);
    const auto below = [&](std::size_t bound) { return static_cast<std::size_t>(random() % bound); };
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };

    std::vector<std::int32_t> nearest(normals.size());
    std::vector<ContactLoad> loads(static_cast<std::size_t>(count));
    for (ContactLoad& load : loads) {
        const Eigen::Vector3d center = point(static_cast<std::int32_t>(below(normals.size())));
        const std::size_t size = std::min(1 + below(most_loaded_nodes), normals.size());
        std::iota(nearest.begin(), nearest.end(), 0);
        std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(size), nearest.end(),
                          [&](std::int32_t a, std::int32_t b) {
                              const double x = (point(a) - center).squaredNorm(),
                                           y = (point(b) - center).squaredNorm();
                              return x < y || (x == y && a < b);
                          });
        for (std::size_t k = 0; k < size; ++k) {
            const Eigen::Vector3d& normal = normals[nearest[k]];
            Eigen::Vector3d across(unit() - 0.5, unit() - 0.5, unit() - 0.5);
            across -= across.dot(normal) * normal;
            const double pressure = unit();
            const Eigen::Vector3d force = pressure * (0.5 * unit() * across.normalized() - normal);
            load.push_back({nearest[k], force.cast<float>()});
        }
    }
    return loads;
}

Eigen::VectorXd displacements_of(const SurfaceCompliance& compliance, const ContactLoad& load) {
    const auto size = 3 * Eigen::Index{node_count(compliance)};
    Eigen::VectorXd u = Eigen::VectorXd::Zero(size);
    if (const auto* dense = std::get_if<DenseCompliance>(&compliance)) {
        for (const NodeForce& force : load)
            for (Eigen::Index axis = 0; axis < 3; ++axis)
                u += double{force.force[axis]} *
                     Eigen::Map<const Eigen::VectorXf>(
                         dense->row(static_cast<std::size_t>(3 * Eigen::Index{force.node} + axis)), size)
                         .cast<double>();
        return u;
    }
    std::vector<Eigen::Vector3f> nodal(static_cast<std::size_t>(size / 3), Eigen::Vector3f::Zero());
    add_displacements(compliance, load, nodal);
    for (std::size_t node = 0; node < nodal.size(); ++node)
        u.segment<3>(3 * static_cast<Eigen::Index>(node)) = nodal[node].cast<double>();
    return u;
}

namespace {

LoadError relative_error(const ContactLoad& load, const Eigen::VectorXd& difference,
                         const Eigen::VectorXd& exact) {
    double worst = 0, largest = 0;
    for (const NodeForce& force : load) {
        const Eigen::Index dof = 3 * Eigen::Index{force.node};
        worst = std::max(worst, difference.segment<3>(dof).norm());
        largest = std::max(largest, exact.segment<3>(dof).norm());
    }
    return {difference.norm() / exact.norm(), worst / largest};
}

// Of each displacement what the entries' rounding may change at most.
Eigen::VectorXd rounding_of(const DenseCompliance& dense, const ContactLoad& load) {
    constexpr double half_a_digit = 0x1p-24;  // of float32, relative
    const auto size = static_cast<Eigen::Index>(dense.dof_count());
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(size);
    for (const NodeForce& force : load)
        for (Eigen::Index axis = 0; axis < 3; ++axis)
            sum += half_a_digit * std::abs(double{force.force[axis]}) *
                   Eigen::Map<const Eigen::VectorXf>(
                       dense.row(static_cast<std::size_t>(3 * Eigen::Index{force.node} + axis)), size)
                       .cast<double>()
                       .cwiseAbs();
    return sum;
}

}  // namespace

LoadError error_of(const SurfaceCompliance& compliance, const ContactLoad& load,
                   const Eigen::VectorXd& exact) {
    return relative_error(load, displacements_of(compliance, load) - exact, exact);
}

LoadError allowed_load_error(const DeformableBody& body, const LoadError& found, std::int32_t count,
                             std::uint64_t seed) {
    const double limit = allowed_error(body.compliance);
    LoadError allowed{limit, limit};
    const auto* dense = std::get_if<DenseCompliance>(&body.compliance);
    if (dense == nullptr || (found.surface <= limit && found.contact <= limit)) return allowed;
    for (const ContactLoad& load : random_contact_loads(body, count, seed)) {
        const LoadError rounding =
            relative_error(load, rounding_of(*dense, load), displacements_of(body.compliance, load));
        allowed.surface = std::max(allowed.surface, rounding.surface);
        allowed.contact = std::max(allowed.contact, rounding.contact);
    }
    return allowed;
}

Eigen::MatrixXd compliance_on(const SurfaceCompliance& compliance, const ContactLoad& load) {
    const auto size = static_cast<Eigen::Index>(load.size());
    Eigen::MatrixXd patch(3 * size, 3 * size);
    for (Eigen::Index i = 0; i < size; ++i)
        for (Eigen::Index j = 0; j < size; ++j)
            patch.block<3, 3>(3 * i, 3 * j) =
                compliance_block(compliance, load[i].node, load[j].node).cast<double>();
    return patch;
}

}  // namespace palpate::fem
