// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/tetrahedra/surface_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <string>

#include "formats/model/errors.hpp"
#include "tools/meshing/measures/tet_faces.hpp"
#include "tools/meshing/surfaces/surface_gap.hpp"
#include "tools/meshing/tetrahedra/move_nodes.hpp"

namespace palpate::meshing {
namespace {

const Eigen::Vector3d& corner(const TetMesh& mesh, const InterfaceFace& face, std::size_t c) {
    return mesh.rest_positions[face.nodes[c]];
}

Eigen::Vector3d area_vector(const TetMesh& mesh, const InterfaceFace& face) {
    const Eigen::Vector3d& a = corner(mesh, face, 0);
    return 0.5 * (corner(mesh, face, 1) - a).cross(corner(mesh, face, 2) - a);
}

void limit_lengths(Eigen::VectorXd& step, double max_length) {
    for (Eigen::Index node = 0; node < step.size() / 3; ++node) {
        const double length = step.segment<3>(3 * node).norm();
        if (length > max_length) step.segment<3>(3 * node) *= max_length / length;
    }
}

// The lumped least-squares displacement of every node, three rows each.
Eigen::VectorXd displacements_to_surface(const TetMesh& mesh, const std::vector<InterfaceFace>& faces,
                                         const SmoothedLabels& labels, double reach) {
    // Weights of a triangle's corners at three points that integrate quadratic functions exactly.
    constexpr std::array<std::array<double, 3>, 3> points{
        {{2.0 / 3, 1.0 / 6, 1.0 / 6}, {1.0 / 6, 2.0 / 3, 1.0 / 6}, {1.0 / 6, 1.0 / 6, 2.0 / 3}}};
    Eigen::VectorXd step = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(mesh.rest_positions.size()));
    std::vector<double> mass(mesh.rest_positions.size(), 0.0);
    for (const InterfaceFace& face : faces) {
        const Eigen::Vector3d area = area_vector(mesh, face);
        const InterfaceSide side{static_cast<std::uint8_t>(face.inner), static_cast<std::uint8_t>(face.outer),
                                 area.normalized()};
        for (const auto& weights : points) {
            const Eigen::Vector3d p = weights[0] * corner(mesh, face, 0) +
                                      weights[1] * corner(mesh, face, 1) + weights[2] * corner(mesh, face, 2);
            const double gap = surface_gap(labels, side, p, reach).value_or(0);
            for (std::size_t c = 0; c < 3; ++c) {
                const auto node = static_cast<std::size_t>(face.nodes[c]);
                step.segment<3>(3 * static_cast<Eigen::Index>(node)) += weights[c] * gap * area;
                mass[node] += weights[c] * area.norm();
            }
        }
    }
    for (std::size_t node = 0; node < mass.size(); ++node)
        if (mass[node] > 0) step.segment<3>(3 * static_cast<Eigen::Index>(node)) /= mass[node];
    return step;
}

Eigen::VectorXd volumes_of(const TetMesh& mesh, std::size_t regions) {
    Eigen::VectorXd volumes = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(regions));
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        volumes[mesh.regions[t] - 1] += six_volume(mesh, t) / 6;
    return volumes;
}

// How far each node moves, per offset of each region: a column per region, three rows per node.
Eigen::MatrixXd push_directions(const TetMesh& mesh, const std::vector<InterfaceFace>& faces,
                                Eigen::Index regions, Eigen::MatrixXd& gradients) {
    const auto nodes = static_cast<Eigen::Index>(mesh.rest_positions.size());
    gradients = Eigen::MatrixXd::Zero(3 * nodes, regions);
    Eigen::VectorXd area = Eigen::VectorXd::Zero(nodes);
    for (const InterfaceFace& face : faces) {
        // A third of the face's area vector: the share of each of its nodes, to first order.
        const Eigen::Vector3d third = area_vector(mesh, face) / 3;
        for (const Eigen::Index node : face.nodes) {
            gradients.block<3, 1>(3 * node, face.inner - 1) += third;
            if (face.outer > 0) gradients.block<3, 1>(3 * node, face.outer - 1) -= third;
            area[node] += third.norm();
        }
    }
    Eigen::MatrixXd directions = gradients;
    for (Eigen::Index node = 0; node < nodes; ++node)
        if (area[node] > 0) directions.middleRows<3>(3 * node) /= area[node];
    return directions;
}

}  // namespace

void fit_surface(TetMesh& mesh, const SmoothedLabels& labels, double floor_deg, double max_distance) {
    const std::vector<InterfaceFace> faces = interface_faces(mesh);
    for (int round = 0; round < 5; ++round) {
        Eigen::VectorXd step = displacements_to_surface(mesh, faces, labels, 2 * max_distance);
        limit_lengths(step, max_distance);
        move_nodes(mesh, step, floor_deg);
    }
}

void match_volumes(TetMesh& mesh, std::span<const double> volumes, double floor_deg, double max_distance) {
    for (const std::int32_t region : mesh.regions)
        if (region < 1 || static_cast<std::size_t>(region) > volumes.size())
            throw InvalidInput({"match_volumes",
                                "region " + std::to_string(region) + " has no volume to match",
                                "one for each region", ""});
    const std::vector<InterfaceFace> faces = interface_faces(mesh);
    const Eigen::Map<const Eigen::VectorXd> targets(volumes.data(),
                                                    static_cast<Eigen::Index>(volumes.size()));
    constexpr int max_rounds = 12;  // nodes that may not move leave more to the others
    for (int round = 0; round < max_rounds; ++round) {
        const Eigen::VectorXd missing = targets - volumes_of(mesh, volumes.size());
        if ((missing.cwiseAbs().array() < 1e-4 * targets.array()).all()) return;
        Eigen::MatrixXd gradients;
        const Eigen::MatrixXd directions = push_directions(mesh, faces, targets.size(), gradients);
        const Eigen::MatrixXd response = gradients.transpose() * directions;
        Eigen::VectorXd step = directions * response.completeOrthogonalDecomposition().solve(missing);
        limit_lengths(step, max_distance);
        move_nodes(mesh, step, floor_deg);
    }
}

}  // namespace palpate::meshing
