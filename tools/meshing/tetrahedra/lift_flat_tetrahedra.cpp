// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/tetrahedra/lift_flat_tetrahedra.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/meshing/measures/quality.hpp"
#include "tools/meshing/measures/tet_faces.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"
#include "tools/meshing/tetrahedra/move_nodes.hpp"

namespace palpate::meshing {
namespace {

class Lifter {
  public:
    Lifter(TetMesh& mesh, double max_surface_move)
        : mesh_(mesh),
          start_(mesh.rest_positions),
          stars_(mesh.rest_positions.size()),
          normals_(mesh.rest_positions.size(), Eigen::Vector3d::Zero()),
          max_surface_move_(max_surface_move) {
        for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
            for (const std::int32_t node : mesh.tetrahedra[t]) stars_[node].push_back(t);
        for (const InterfaceFace& face : interface_faces(mesh)) {
            const auto corner = [&](std::size_t c) -> const Eigen::Vector3d& {
                return start_[face.nodes[c]];
            };
            // Always seen from the same region, so that the normals of one interface add up.
            const double side = face.outer > 0 && face.inner > face.outer ? -1 : 1;
            const Eigen::Vector3d area = side * (corner(1) - corner(0)).cross(corner(2) - corner(0));
            for (const std::int32_t node : face.nodes) normals_[node] += area;
        }
        for (Eigen::Vector3d& normal : normals_) normal.normalize();
    }

    // One pass over all tetrahedra flatter than the bound, flattest first; tells whether anything moved.
    bool pass(double bound_deg) {
        std::vector<std::pair<double, std::size_t>> flat;
        for (std::size_t t = 0; t < mesh_.tetrahedra.size(); ++t)
            if (const double angle = flatness_deg(mesh_, t); angle < bound_deg) flat.emplace_back(angle, t);
        std::ranges::sort(flat);
        bool moved = false;
        for (const auto& [angle, t] : flat)
            for (const std::int32_t node : mesh_.tetrahedra[t])
                moved |= improve(static_cast<std::size_t>(node));
        return moved;
    }

  private:
    // Interior nodes, which have no normal, may go anywhere.
    bool within_reach(std::size_t node) const {
        if (normals_[node].isZero()) return true;
        const Eigen::Vector3d way = mesh_.rest_positions[node] - start_[node];
        const double height = way.dot(normals_[node]);
        return std::abs(height) <= max_surface_move_ &&
               (way - height * normals_[node]).norm() <= 4 * max_surface_move_;
    }

    double flattest_around(std::size_t node) const {
        double flattest = 180;
        for (const std::size_t t : stars_[node]) {
            if (!(six_volume(mesh_, t) > 0)) return 0;
            flattest = std::min(flattest, flatness_deg(mesh_, t));
        }
        return flattest;
    }

    double shortest_edge(std::size_t node) const {
        double shortest = std::numeric_limits<double>::max();
        for (const std::size_t t : stars_[node])
            for (const std::int32_t other : mesh_.tetrahedra[t])
                if (static_cast<std::size_t>(other) != node)
                    shortest =
                        std::min(shortest, (mesh_.rest_positions[other] - mesh_.rest_positions[node]).norm());
        return shortest;
    }

    // A pattern search: the 26 neighbours on a lattice that gets finer.
    bool improve(std::size_t node) {
        Eigen::Vector3d& position = mesh_.rest_positions[node];
        const double edge = shortest_edge(node), before = flattest_around(node);
        double best = before;
        Eigen::Vector3d best_position = position;
        for (const double step : {0.2 * edge, 0.05 * edge, 0.0125 * edge}) {
            const Eigen::Vector3d center = best_position;
            for (int k = -1; k <= 1; ++k)
                for (int j = -1; j <= 1; ++j)
                    for (int i = -1; i <= 1; ++i) {
                        position = center + step * Eigen::Vector3d(i, j, k);
                        if (!within_reach(node)) continue;
                        if (const double now = flattest_around(node); now > best) {
                            best = now;
                            best_position = position;
                        }
                    }
        }
        position = best_position;
        return best > before;
    }

    TetMesh& mesh_;
    std::vector<Eigen::Vector3d> start_;
    std::vector<std::vector<std::size_t>> stars_;
    std::vector<Eigen::Vector3d> normals_;
    double max_surface_move_;
};

}  // namespace

void lift_flat_tetrahedra(TetMesh& mesh, double bound_deg, double max_surface_move) {
    constexpr int max_passes = 10;
    Lifter lifter(mesh, max_surface_move);
    const std::vector<Eigen::Vector3d> start = mesh.rest_positions;
    for (int pass = 0; pass < max_passes && lifter.pass(bound_deg); ++pass) {
    }
    if (!first_self_intersection(boundary_surface(mesh).surface)) return;
    // Two sheets of the boundary got through each other, of which no tetrahedron knows.
    Eigen::VectorXd lift(3 * static_cast<Eigen::Index>(start.size()));
    for (std::size_t node = 0; node < start.size(); ++node)
        lift.segment<3>(3 * static_cast<Eigen::Index>(node)) = mesh.rest_positions[node] - start[node];
    mesh.rest_positions = start;
    move_nodes(mesh, lift, bound_deg);
}

}  // namespace palpate::meshing
