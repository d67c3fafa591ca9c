// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <memory>
#include <vector>

#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/certificate/linear_limits.hpp"

namespace palpate {
namespace {

using namespace fem;

DeformableBody block(double poissons_ratio, ElementOrder order = ElementOrder::linear) {
    DeformableBody body = test::held_block({6, 6, 4}, {30, 30, 20},
                                           {.youngs_modulus = 6.3e-3, .poissons_ratio = poissons_ratio});
    test::jitter_interior(body.mesh, 0.75, 1);
    body.element_order = order;
    return condensed_body(prepared_body(std::move(body)), test::no_progress);
}

TEST(LinearLimits, are_of_the_strain_that_was_asked_for) {
    for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic})
        for (const double strain : {0.02, 0.25})
            EXPECT_NEAR(find_linear_limits(block(0.45, order), strain).strain, strain, 0.03 * strain);
}

// A linear answer is the first term of the tissue's: what it misses falls with the strain, and is nothing at
// none.
TEST(LinearLimits, vanish_with_the_strain) {
    const DeformableBody body = block(0.45);
    const LinearLimits tiny = find_linear_limits(body, 0.002), small = find_linear_limits(body, 0.02),
                       large = find_linear_limits(body, 0.2);
    EXPECT_LT(tiny.force_error, 0.002);
    EXPECT_LT(tiny.surface_error, 0.004);
    EXPECT_NEAR(small.force_error / tiny.force_error, 10, 2);
    EXPECT_NEAR(small.surface_error / tiny.surface_error, 10, 2);
    EXPECT_NEAR(large.depth / small.depth, 10, 2);
    EXPECT_GT(large.force_error, 3 * small.force_error);
    EXPECT_GT(large.surface_error, 3 * small.surface_error);
}

// What is off is the answer that is stored, whatever it is off by.
TEST(LinearLimits, blame_the_stored_compliance) {
    DeformableBody body = block(0.45);
    auto& dense = std::get<DenseCompliance>(body.compliance);
    const auto doubled = std::make_shared<std::vector<float>>(
        dense.entries.get(), dense.entries.get() + dense.dof_count() * dense.dof_count());
    for (float& entry : *doubled) entry *= 2;
    dense.entries = std::shared_ptr<const float>(doubled, doubled->data());
    EXPECT_NEAR(find_linear_limits(body, 0.002).force_error, 0.5, 0.002);
}

TEST(LinearLimits, are_not_told_of_what_has_no_large_answer) {
    EXPECT_EQ(find_linear_limits(block(0.49995)).strain, -1);
    DeformableBody barely = block(0.45);
    barely.fixed_nodes.resize(2);
    EXPECT_EQ(find_linear_limits(barely).strain, -1);
    const DeformableBody large = prepared_body(
        test::held_block({20, 20, 18}, {40, 40, 36}, {.youngs_modulus = 6.3e-3, .poissons_ratio = 0.45}));
    EXPECT_EQ(find_linear_limits(large).strain, -1);
}

}  // namespace
}  // namespace palpate
