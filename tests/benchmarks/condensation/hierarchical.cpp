// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/benchmarks/condensation/hierarchical.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "tools/fem/condensation/condense.hpp"
#include "tools/fem/solvers/dense_kernels.hpp"
#include "tools/fem/solvers/free_system.hpp"

namespace palpate {
namespace {

using namespace fem;

constexpr double accuracy = 1e-3;
constexpr std::size_t patch_nodes = 32;
constexpr int patches = 100;

std::vector<Eigen::Vector3d> contact_points(const DeformableBody& body) {
    std::vector<Eigen::Vector3d> points;
    for (const std::int32_t node : body.contact_nodes)
        points.push_back(body.mesh.rest_positions[static_cast<std::size_t>(node)]);
    return points;
}

// Random forces on a random contact node and those nearest to it.
std::vector<NodeForce> random_patch(const std::vector<Eigen::Vector3d>& points, std::mt19937_64& random) {
    std::normal_distribution<float> normal;
    const Eigen::Vector3d center = points[random() % points.size()];
    std::vector<std::int32_t> nodes(points.size());
    std::iota(nodes.begin(), nodes.end(), 0);
    const std::size_t count = std::min(patch_nodes, nodes.size());
    std::ranges::partial_sort(
        nodes, nodes.begin() + static_cast<std::ptrdiff_t>(count), {},
        [&](std::int32_t node) { return (points[static_cast<std::size_t>(node)] - center).squaredNorm(); });
    std::vector<NodeForce> forces;
    for (std::size_t k = 0; k < count; ++k) {
        const float x = normal(random), y = normal(random), z = normal(random);
        forces.push_back({nodes[k], {x, y, z}});
    }
    return forces;
}

double median(std::vector<double> values) {
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return values[values.size() / 2];
}

// C_cc of one patch, by its lower half; the sum keeps the compiler from leaving it out.
float block_sum(const SurfaceCompliance& compliance, const std::vector<NodeForce>& forces) {
    Eigen::Matrix3f sum = Eigen::Matrix3f::Zero();
    for (std::size_t a = 0; a < forces.size(); ++a)
        for (std::size_t b = 0; b <= a; ++b)
            sum += compliance_block(compliance, forces[a].node, forces[b].node);
    return sum.sum();
}

Json query(const SurfaceCompliance& compliance, const FreeSystem& system, const SparseCholesky& factor,
           const std::vector<Eigen::Vector3d>& points) {
    const auto& rows = system.contact_rows;
    std::mt19937_64 random(1);
    std::vector<double> block_us, displacements_ms;
    float checksum = 0;
    double worst = 0;
    for (int patch = 0; patch < patches; ++patch) {
        const std::vector<NodeForce> forces = random_patch(points, random);
        std::vector<Eigen::Vector3f> u(points.size(), Eigen::Vector3f::Zero());
        const double begin = now_seconds();
        checksum += block_sum(compliance, forces);
        const double between = now_seconds();
        add_displacements(compliance, forces, u);
        displacements_ms.push_back(1e3 * (now_seconds() - between));
        block_us.push_back(1e6 * (between - begin));

        Eigen::MatrixXd load = Eigen::MatrixXd::Zero(system.stiffness.rows(), 1);
        for (const NodeForce& force : forces)
            for (Eigen::Index axis = 0; axis < 3; ++axis)
                load(rows[3 * static_cast<std::size_t>(force.node) + static_cast<std::size_t>(axis)], 0) =
                    double{force.force[axis]};
        const Eigen::MatrixXd exact = factor.solve(load);
        double error = 0, size = 0;
        for (std::size_t dof = 0; dof < rows.size(); ++dof) {
            const double expected = exact(rows[dof], 0);
            error += std::pow(double{u[dof / 3][static_cast<Eigen::Index>(dof % 3)]} - expected, 2);
            size += expected * expected;
        }
        worst = std::max(worst, std::sqrt(error / size));
    }
    return {{"error", worst},
            {"block_us", median(block_us)},
            {"displacements_ms", median(displacements_ms)},
            {"checksum", checksum}};
}

}  // namespace

Json measure_hierarchical(const DeformableBody& body, int threads) {
    set_linear_algebra_threads(threads);
    SurfaceCompliance compliance;
    const Cost cost = cost_of([&] {
        compliance = condense_hierarchically(body, accuracy, threads, [](std::string_view, double) {});
    });
    Json result = to_json(cost);
    result["bytes"] = value_bytes(compliance);
    const FreeSystem system = assemble_free_system(body, NodeOrder::as_numbered);
    const SparseCholesky factor = factorise(body, system, Elimination::fill_reducing);
    result.update(query(compliance, system, factor, contact_points(body)));
    return result;
}

}  // namespace palpate
