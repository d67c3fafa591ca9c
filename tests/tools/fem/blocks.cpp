// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/fem/blocks.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>
#include <random>

#include "formats/elasticity/stiffness.hpp"

namespace palpate::test {

TetMesh block_mesh(std::array<int, 3> cells, const Eigen::Vector3d& size) {
    TetMesh mesh;
    const auto id = [&](int i, int j, int k) { return (k * (cells[1] + 1) + j) * (cells[0] + 1) + i; };
    for (int k = 0; k <= cells[2]; ++k)
        for (int j = 0; j <= cells[1]; ++j)
            for (int i = 0; i <= cells[0]; ++i)
                mesh.rest_positions.push_back(size.cwiseProduct(
                    Eigen::Vector3d(double(i) / cells[0], double(j) / cells[1], double(k) / cells[2])));
    // Kuhn: one tetrahedron per order in which the three axes are walked from corner 000 to corner 111.
    constexpr std::array<std::array<int, 3>, 6> walks{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    for (int k = 0; k < cells[2]; ++k)
        for (int j = 0; j < cells[1]; ++j)
            for (int i = 0; i < cells[0]; ++i)
                for (const auto& walk : walks) {
                    std::array<int, 3> at{i, j, k};
                    Tetrahedron tet{id(i, j, k), 0, 0, 0};
                    for (std::size_t step = 0; step < 3; ++step) {
                        ++at[static_cast<std::size_t>(walk[step])];
                        tet[step + 1] = id(at[0], at[1], at[2]);
                    }
                    mesh.tetrahedra.push_back(tet);
                    mesh.regions.push_back(1);
                    if (six_volume(mesh, mesh.tetrahedra.size() - 1) < 0)
                        std::swap(mesh.tetrahedra.back()[2], mesh.tetrahedra.back()[3]);
                }
    mesh.region_names = {{1, "block", {1, 0, 0}}};
    return mesh;
}

TetMesh macneal_harder_cube() {
    TetMesh mesh;
    // Corners and inner nodes in the same order, so that inner node 8 + c lies towards corner c.
    mesh.rest_positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                           {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    mesh.rest_positions.insert(mesh.rest_positions.end(), {{.249, .342, .192},
                                                           {.826, .288, .288},
                                                           {.850, .649, .263},
                                                           {.273, .750, .230},
                                                           {.320, .186, .643},
                                                           {.677, .305, .683},
                                                           {.788, .693, .644},
                                                           {.165, .745, .702}});
    // A hexahedron's sides, outwards, corners numbered as those of the cube.
    constexpr std::array<std::array<std::size_t, 4>, 6> sides{
        {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
    using Hexahedron = std::array<std::int32_t, 8>;
    std::vector<Hexahedron> hexahedra{{8, 9, 10, 11, 12, 13, 14, 15}};
    for (const auto& side : sides) {
        Hexahedron outer{};
        for (std::size_t c = 0; c < 4; ++c) {
            outer[c] = 8 + static_cast<std::int32_t>(side[c]);
            outer[4 + c] = static_cast<std::int32_t>(side[c]);
        }
        hexahedra.push_back(outer);
    }
    // Every quadrilateral is cut from its lowest node, so neighbours agree; a hexahedron is the cone from its
    // lowest node over the sides that do not contain it.
    for (const Hexahedron& hexahedron : hexahedra) {
        const std::int32_t apex = *std::ranges::min_element(hexahedron);
        for (const auto& side : sides) {
            std::array<std::int32_t, 4> quad{};
            for (std::size_t c = 0; c < 4; ++c) quad[c] = hexahedron[side[c]];
            std::ranges::rotate(quad, std::ranges::min_element(quad));
            if (quad[0] == apex) continue;
            mesh.tetrahedra.push_back({apex, quad[0], quad[1], quad[2]});
            mesh.tetrahedra.push_back({apex, quad[0], quad[2], quad[3]});
        }
    }
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (six_volume(mesh, t) < 0) std::swap(mesh.tetrahedra[t][2], mesh.tetrahedra[t][3]);
    mesh.regions.assign(mesh.tetrahedra.size(), 1);
    mesh.region_names = {{1, "cube", {1, 0, 0}}};
    return mesh;
}

void jitter_interior(TetMesh& mesh, double amount, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-amount, amount);
    const auto boundary = boundary_surface(mesh).nodes;
    for (std::size_t node = 0; node < mesh.rest_positions.size(); ++node)
        if (!std::ranges::binary_search(boundary, static_cast<std::int32_t>(node)))
            for (int axis = 0; axis < 3; ++axis) mesh.rest_positions[node][axis] += uniform(random);
}

std::vector<std::int32_t> nodes_where(const TetMesh& mesh,
                                      const std::function<bool(const Eigen::Vector3d&)>& condition) {
    std::vector<std::int32_t> nodes;
    for (std::size_t node = 0; node < mesh.rest_positions.size(); ++node)
        if (condition(mesh.rest_positions[node])) nodes.push_back(static_cast<std::int32_t>(node));
    return nodes;
}

DeformableBody held_block(std::array<int, 3> cells, const Eigen::Vector3d& size, const Material& material) {
    DeformableBody body;
    body.name = "block";
    body.mesh = block_mesh(cells, size);
    body.materials = {{1, material}};
    body.fixed_nodes = nodes_where(body.mesh, [](const Eigen::Vector3d& p) { return p.z() < 1e-9; });
    return body;
}

std::vector<Eigen::Vector3d> node_positions(const DeformableBody& body) {
    std::vector<Eigen::Vector3d> positions = body.mesh.rest_positions;
    for (const auto& [a, b] : elasticity::discretise(body).edges)
        positions.push_back(
            (positions[static_cast<std::size_t>(a)] + positions[static_cast<std::size_t>(b)]) / 2);
    return positions;
}

std::vector<std::int32_t> boundary_nodes(const DeformableBody& body) {
    return elasticity::discretise(body.mesh, body.element_order, boundary_surface(body.mesh).nodes)
        .fixed_nodes;
}

Eigen::VectorXd sampled(const DeformableBody& body,
                        const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& field) {
    const auto positions = node_positions(body);
    Eigen::VectorXd u(static_cast<Eigen::Index>(3 * positions.size()));
    for (std::size_t node = 0; node < positions.size(); ++node)
        u.segment<3>(static_cast<Eigen::Index>(3 * node)) = field(positions[node]);
    return u;
}

Eigen::MatrixXd full_stiffness(const DeformableBody& body) {
    const elasticity::Discretisation discretisation = elasticity::discretise(body);
    std::vector<std::int32_t> all(discretisation.node_count);
    std::iota(all.begin(), all.end(), 0);
    const elasticity::LowerSparse lower =
        elasticity::assemble_stiffness(body.mesh, body.materials, discretisation, all);
    const Eigen::MatrixXd dense(lower);
    return dense.selfadjointView<Eigen::Lower>();
}

Eigen::VectorXd solve_dense(const DeformableBody& body, std::span<const std::int32_t> held,
                            const Eigen::VectorXd& prescribed, const Eigen::VectorXd& forces) {
    const Eigen::MatrixXd K = full_stiffness(body);
    std::vector<Eigen::Index> free, fixed;
    for (Eigen::Index dof = 0; dof < K.rows(); ++dof) {
        const bool is_held = std::ranges::binary_search(held, static_cast<std::int32_t>(dof / 3));
        (is_held ? fixed : free).push_back(dof);
    }
    Eigen::VectorXd u = prescribed;
    const Eigen::VectorXd right = forces(free) - K(free, fixed) * prescribed(fixed);
    const Eigen::MatrixXd K_free = K(free, free);
    const Eigen::VectorXd u_free = K_free.llt().solve(right);
    u(free) = u_free;
    return u;
}

}  // namespace palpate::test
