// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/feel/pressing.hpp"

#include <algorithm>
#include <cmath>

#include "formats/model/contact/compliance_blocks.hpp"
#include "formats/model/contact/local_indentation.hpp"
#include "formats/model/contact/surface_walk.hpp"
#include "tools/fem/solvers/dense_kernels.hpp"
#include "tools/fem/solvers/free_system.hpp"
#include "tools/fem/solvers/panel_solver.hpp"

namespace palpate::fem {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

// R / a at which s(F) is largest: F = 0.3701 E* R³ / r and Hertz's F = 4/3 E* a³ / r.
constexpr double disc_in_contact_radii = 1.533;

// How much wider than the mesh's a disc may be: a vertex' cost grows as the fourth power.
constexpr double widest_disc = 3;

}  // namespace

Pressing pressing_of(const DeformableBody& body, double tool_radius, double depth) {
    Pressing pressing{.tool_radius = tool_radius,
                      .depth = depth,
                      .disc = {},
                      .blocks = compliance_blocks(body),
                      .shares = {},
                      .normals = vertex_shapes(body.boundary.surface).normals};
    const SpreadDisc of_mesh = spread_disc(body, pressing.blocks);
    pressing.disc = widened(of_mesh, std::min(disc_in_contact_radii * std::sqrt(tool_radius * depth),
                                              widest_disc * of_mesh.reach));
    pressing.shares = load_shares(body, pressing.blocks, pressing.disc.reach);
    return pressing;
}

bool can_be_pressed(const Pressing& pressing, std::int32_t vertex) {
    return pressing.blocks[static_cast<std::size_t>(vertex)] >= 0;
}

std::vector<double> spread_compliances(const DeformableBody& body, const Pressing& pressing, int threads) {
    std::vector<double> compliances(pressing.blocks.size(), 0);
    for_each_index(compliances.size(), threads, [&](std::size_t v) {
        const auto vertex = static_cast<std::int32_t>(v);
        if (!can_be_pressed(pressing, vertex)) return;
        const Eigen::Vector3f normal = pressing.normals[v].cast<float>();
        const auto shares = pressing.shares.of(vertex);
        const auto block = [&](const LoadShare& share) {
            return pressing.blocks[static_cast<std::size_t>(share.vertex)];
        };
        double sum = 0;  // C is symmetric: each pair once
        for (std::size_t i = 0; i < shares.size(); ++i)
            for (std::size_t j = 0; j <= i; ++j) {
                const float between = normal.dot(
                    compliance_block(body.compliance, block(shares[i]), block(shares[j])) * normal);
                sum += (i == j ? 1 : 2) * static_cast<double>(shares[i].weight) *
                       static_cast<double>(shares[j].weight) * static_cast<double>(between);
            }
        compliances[v] = sum;
    });
    return compliances;
}

std::vector<double> solved_compliances(const DeformableBody& body, const Pressing& pressing,
                                       std::span<const std::int32_t> vertices, int threads) {
    constexpr std::size_t panel_loads = 32;
    const FreeSystem system = assemble_free_system(body, NodeOrder::nested_dissection);
    const SparseCholesky factor = factorise(body, system, Elimination::as_given);
    std::vector<double> compliances(vertices.size(), 0);
    for_each_index((vertices.size() + panel_loads - 1) / panel_loads, threads, [&](std::size_t panel) {
        const std::size_t first = panel * panel_loads;
        const auto some = vertices.subspan(first, std::min(panel_loads, vertices.size() - first));
        std::vector<std::int64_t> wanted;
        std::vector<PanelLoad> loads;
        for (std::size_t k = 0; k < some.size(); ++k) {
            const Vector3d& normal = pressing.normals[static_cast<std::size_t>(some[k])];
            for (const LoadShare& share : pressing.shares.of(some[k]))
                for (Index axis = 0; axis < 3; ++axis) {
                    const Index block = pressing.blocks[static_cast<std::size_t>(share.vertex)];
                    wanted.push_back(system.contact_rows[static_cast<std::size_t>(3 * block + axis)]);
                    loads.push_back({wanted.back(), static_cast<Index>(k),
                                     static_cast<double>(share.weight) * normal[axis]});
                }
        }
        // What is pressed is what is asked for, so the loads serve to sum up the solutions.
        const Eigen::MatrixXd u = PanelSolver(factor, wanted).solve(loads, static_cast<Index>(some.size()));
        for (std::size_t i = 0; i < loads.size(); ++i)
            compliances[first + static_cast<std::size_t>(loads[i].load)] +=
                loads[i].value * u(loads[i].load, static_cast<Index>(i));
    });
    return compliances;
}

double pressed_stiffness(const Pressing& pressing, double compliance, double contact_modulus) {
    const auto depth_under = [&](double force) {
        return compliance * force +
               local_indentation(force, pressing.tool_radius, contact_modulus, pressing.disc.radius).depth;
    };
    // The depth grows with the force; bisected to the last bit but a few.
    double low = 0, high = pressing.depth / compliance;
    constexpr int halvings = 50;
    for (int step = 0; step < halvings; ++step) {
        const double middle = (low + high) / 2;
        (depth_under(middle) < pressing.depth ? low : high) = middle;
    }
    return high / pressing.depth;
}

}  // namespace palpate::fem
