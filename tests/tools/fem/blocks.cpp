// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/fem/blocks.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>
#include <random>

#include "tools/fem/stiffness.hpp"

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

Eigen::MatrixXd full_stiffness(const DeformableBody& body) {
    const Discretisation discretisation = discretise(body);
    std::vector<std::int32_t> all(discretisation.node_count);
    std::iota(all.begin(), all.end(), 0);
    const LowerSparse lower = assemble_stiffness(body.mesh, body.materials, discretisation, all);
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
