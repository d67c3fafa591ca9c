// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/fem/compliances.hpp"

#include "tests/tools/fem/blocks.hpp"

namespace palpate::test {

using namespace fem;

std::vector<ExactMethod> exact_methods() {
    return {{"trailing_block",
             [](const DeformableBody& body) { return full(condense_by_trailing_block(body, no_progress)); }},
            {"solves",
             [](const DeformableBody& body) { return full(condense_by_solves(body, 2, no_progress)); }}};
}

std::string name_of(const testing::TestParamInfo<ExactMethod>& method) {
    return std::string(method.param.name);
}

Eigen::MatrixXd full(const ExactCompliance& exact) {
    return exact.lower.selfadjointView<Eigen::Lower>();
}

Eigen::MatrixXd entries_of(const SurfaceCompliance& compliance) {
    const std::int32_t nodes = node_count(compliance);
    Eigen::MatrixXd entries(3 * nodes, 3 * nodes);
    for (std::int32_t a = 0; a < nodes; ++a)
        for (std::int32_t b = 0; b < nodes; ++b)
            entries.block<3, 3>(3 * a, 3 * b) = compliance_block(compliance, a, b).cast<double>();
    return entries;
}

std::vector<Eigen::Index> dofs_of(const std::vector<std::int32_t>& nodes) {
    std::vector<Eigen::Index> dofs;
    for (const std::int32_t node : nodes)
        for (Eigen::Index axis = 0; axis < 3; ++axis) dofs.push_back(3 * Eigen::Index{node} + axis);
    return dofs;
}

DeformableBody lumpy_block() {
    DeformableBody body = held_block({4, 3, 3}, {8, 6, 7}, {.youngs_modulus = 6e-3, .poissons_ratio = 0.45});
    jitter_interior(body.mesh, 0.4, 3);
    body.mesh.regions[20] = body.mesh.regions[21] = 2;
    body.mesh.region_names.push_back({2, "lump", {0, 1, 0}});
    body.materials.push_back({2, {.youngs_modulus = 30e-3, .poissons_ratio = 0.4}});
    return prepared_body(std::move(body));
}

DeformableBody large_block() {
    return prepared_body(
        held_block({12, 12, 12}, {24, 24, 24}, {.youngs_modulus = 6e-3, .poissons_ratio = 0.45}));
}

}  // namespace palpate::test
