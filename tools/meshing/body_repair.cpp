// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/body_repair.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <string>

#include "formats/model/errors.hpp"
#include "tools/meshing/disjoint_sets.hpp"
#include "tools/meshing/tet_faces.hpp"

namespace palpate {
namespace {

// A face with different regions on its two sides, seen from `inner`; outer is 0 on the boundary.
struct InterfaceFace {
    Triangle nodes;  // counter-clockwise seen from the outer side
    Eigen::Index inner, outer;
};

// Regions are numbered by their place in `targets`, starting from 1.
std::vector<InterfaceFace> interface_faces(const TetMesh& mesh, std::span<const RegionVolume> targets) {
    const auto number = [&](std::size_t tet) -> Eigen::Index {
        const auto found = std::ranges::find(targets, mesh.regions[tet], &RegionVolume::region);
        if (found == targets.end())
            throw InvalidInput({"match_volumes",
                                "region " + std::to_string(mesh.regions[tet]) + " has no target",
                                "one for each region", ""});
        return found - targets.begin() + 1;
    };
    std::vector<InterfaceFace> result;
    const std::vector<TetFace> faces = sorted_faces(mesh);
    for (std::size_t i = 0; i < faces.size();) {
        const bool shared = i + 1 < faces.size() && faces[i + 1].sorted_nodes == faces[i].sorted_nodes;
        const Eigen::Index inner = number(faces[i].tet), outer = shared ? number(faces[i + 1].tet) : 0;
        if (inner != outer) {
            const Tetrahedron& tet = mesh.tetrahedra[faces[i].tet];
            const auto& corner = tetrahedron_faces[faces[i].face];
            result.push_back({{tet[corner[0]], tet[corner[1]], tet[corner[2]]}, inner, outer});
        }
        i += shared ? 2 : 1;
    }
    return result;
}

Eigen::VectorXd volumes_of(const TetMesh& mesh, std::span<const RegionVolume> targets) {
    Eigen::VectorXd volumes = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(targets.size()));
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        volumes[std::ranges::find(targets, mesh.regions[t], &RegionVolume::region) - targets.begin()] +=
            six_volume(mesh, t) / 6;
    return volumes;
}

// How far each node moves, per offset of each region: a column per region, three rows per node.
Eigen::MatrixXd push_directions(const TetMesh& mesh, const std::vector<InterfaceFace>& faces,
                                Eigen::Index regions, Eigen::MatrixXd& gradients) {
    const auto nodes = static_cast<Eigen::Index>(mesh.rest_positions.size());
    gradients = Eigen::MatrixXd::Zero(3 * nodes, regions);
    Eigen::VectorXd area = Eigen::VectorXd::Zero(nodes);
    for (const InterfaceFace& face : faces) {
        const auto point = [&](std::size_t c) -> const Eigen::Vector3d& {
            return mesh.rest_positions[static_cast<std::size_t>(face.nodes[c])];
        };
        // A third of the face's area vector: the share of each of its nodes, to first order.
        const Eigen::Vector3d third = (point(1) - point(0)).cross(point(2) - point(0)) / 6;
        for (const std::int32_t node : face.nodes) {
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

// Adds `step`, halved as often as it takes at the nodes of every tetrahedron whose smallest dihedral angle
// would fall below nine tenths of what it is.
void move_nodes(TetMesh& mesh, const Eigen::VectorXd& step) {
    const std::vector<Eigen::Vector3d> before = mesh.rest_positions;
    std::vector<double> lowest(mesh.tetrahedra.size()), fraction(before.size(), 1.0);
    for (std::size_t t = 0; t < lowest.size(); ++t) lowest[t] = 0.9 * flatness_deg(mesh, t);
    for (int halvings = 0; halvings < 8; ++halvings) {
        for (std::size_t node = 0; node < before.size(); ++node)
            mesh.rest_positions[node] =
                before[node] + fraction[node] * step.segment<3>(3 * static_cast<Eigen::Index>(node));
        std::vector<bool> halve(before.size(), false);
        bool sound = true;
        for (std::size_t t = 0; t < lowest.size(); ++t) {
            if (six_volume(mesh, t) > 0 && flatness_deg(mesh, t) >= lowest[t]) continue;
            sound = false;
            for (const std::int32_t node : mesh.tetrahedra[t]) halve[static_cast<std::size_t>(node)] = true;
        }
        if (sound) return;
        for (std::size_t node = 0; node < before.size(); ++node)
            if (halve[node]) fraction[node] *= 0.5;
    }
    mesh.rest_positions = before;
}

}  // namespace

std::vector<TetFace> sorted_faces(const TetMesh& mesh) {
    std::vector<TetFace> faces;
    faces.reserve(4 * mesh.tetrahedra.size());
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (std::size_t f = 0; f < 4; ++f) {
            const Tetrahedron& tet = mesh.tetrahedra[t];
            Triangle nodes{tet[tetrahedron_faces[f][0]], tet[tetrahedron_faces[f][1]],
                           tet[tetrahedron_faces[f][2]]};
            std::ranges::sort(nodes);
            faces.push_back({nodes, t, f});
        }
    std::ranges::sort(faces, [](const TetFace& a, const TetFace& b) {
        return a.sorted_nodes != b.sorted_nodes ? a.sorted_nodes < b.sorted_nodes : a.tet < b.tet;
    });
    return faces;
}

std::int64_t split_hinges(TetMesh& mesh) {
    // Corners of tetrahedra that share a face are one node; corners that only share a node are not.
    DisjointSets corners(4 * mesh.tetrahedra.size());
    const auto corner_at = [&](std::size_t tet, std::int32_t node) {
        return 4 * tet + static_cast<std::size_t>(std::ranges::find(mesh.tetrahedra[tet], node) -
                                                  mesh.tetrahedra[tet].begin());
    };
    const std::vector<TetFace> faces = sorted_faces(mesh);
    for (std::size_t i = 1; i < faces.size(); ++i)
        if (faces[i].sorted_nodes == faces[i - 1].sorted_nodes)
            for (const std::int32_t node : faces[i].sorted_nodes)
                corners.join(corner_at(faces[i].tet, node), corner_at(faces[i - 1].tet, node));

    const std::size_t nodes_before = mesh.rest_positions.size();
    std::vector<bool> taken(nodes_before, false);
    std::vector<std::int32_t> node_of(4 * mesh.tetrahedra.size(), -1);
    for (std::size_t corner = 0; corner < node_of.size(); ++corner) {
        std::int32_t& own = mesh.tetrahedra[corner / 4][corner % 4];
        std::int32_t& chosen = node_of[corners.root(corner)];
        if (chosen < 0) {
            chosen = own;
            if (taken[static_cast<std::size_t>(own)]) {
                chosen = static_cast<std::int32_t>(mesh.rest_positions.size());
                mesh.rest_positions.push_back(mesh.rest_positions[static_cast<std::size_t>(own)]);
            }
            taken[static_cast<std::size_t>(own)] = true;
        }
        own = chosen;
    }
    return static_cast<std::int64_t>(mesh.rest_positions.size() - nodes_before);
}

std::int64_t remove_crumbs(TetMesh& mesh, double min_volume) {
    const std::vector<std::int32_t> piece = face_components(mesh);
    std::vector<double> volumes(static_cast<std::size_t>(std::ranges::max(piece)) + 1, 0.0);
    for (std::size_t t = 0; t < piece.size(); ++t)
        volumes[static_cast<std::size_t>(piece[t])] += six_volume(mesh, t) / 6;
    TetMesh kept;
    std::vector<std::int32_t> node_of(mesh.rest_positions.size(), -1);
    for (std::size_t t = 0; t < piece.size(); ++t) {
        if (volumes[static_cast<std::size_t>(piece[t])] < min_volume) continue;
        Tetrahedron tet = mesh.tetrahedra[t];
        for (std::int32_t& node : tet) {
            std::int32_t& id = node_of[static_cast<std::size_t>(node)];
            if (id < 0) {
                id = static_cast<std::int32_t>(kept.rest_positions.size());
                kept.rest_positions.push_back(mesh.rest_positions[static_cast<std::size_t>(node)]);
            }
            node = id;
        }
        kept.tetrahedra.push_back(tet);
        kept.regions.push_back(mesh.regions[t]);
    }
    mesh.rest_positions = std::move(kept.rest_positions);
    mesh.tetrahedra = std::move(kept.tetrahedra);
    mesh.regions = std::move(kept.regions);
    return std::ranges::count_if(volumes, [&](double volume) { return volume < min_volume; });
}

void match_volumes(TetMesh& mesh, std::span<const RegionVolume> targets, double max_distance) {
    const std::vector<InterfaceFace> faces = interface_faces(mesh, targets);
    const auto regions = static_cast<Eigen::Index>(targets.size());
    for (int round = 0; round < 5; ++round) {
        Eigen::VectorXd missing = -volumes_of(mesh, targets);
        double worst = 0;
        for (Eigen::Index k = 0; k < regions; ++k) {
            const double target = targets[static_cast<std::size_t>(k)].volume;
            missing[k] += target;
            worst = std::max(worst, std::abs(missing[k]) / target);
        }
        if (worst < 1e-4) return;
        Eigen::MatrixXd gradients;
        const Eigen::MatrixXd directions = push_directions(mesh, faces, regions, gradients);
        const Eigen::MatrixXd response = gradients.transpose() * directions;
        Eigen::VectorXd step = directions * response.completeOrthogonalDecomposition().solve(missing);
        for (Eigen::Index node = 0; node < step.size() / 3; ++node) {
            const double length = step.segment<3>(3 * node).norm();
            if (length > max_distance) step.segment<3>(3 * node) *= max_distance / length;
        }
        move_nodes(mesh, step);
    }
}

}  // namespace palpate
