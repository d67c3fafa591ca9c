// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/tools/fem/compliances.hpp"

namespace palpate {
namespace {

using namespace fem;

TEST(HierarchicalCondensation, is_certified_to_its_accuracy_and_as_large_as_forecast) {
    DeformableBody body = test::large_block();
    constexpr double accuracy = 1e-3;
    const CondensationPlan plan = plan_condensation(
        body, {.representation = Representation::hierarchical, .accuracy = accuracy, .threads = 2});
    body = condensed_body(std::move(body), plan, test::no_progress);
    ASSERT_TRUE(std::holds_alternative<HierarchicalCompliance>(body.compliance));
    EXPECT_EQ(std::get<HierarchicalCompliance>(body.compliance).accuracy, accuracy);
    const Certificate& c = body.certificate;
    EXPECT_EQ(c.sampled_loads, 1000);
    EXPECT_LT(c.load_error, accuracy);
    EXPECT_LT(c.contact_error, accuracy);
    EXPECT_GT(c.load_error, accuracy / 100);  // a compressed matrix is not exact
    EXPECT_EQ(c.residual_double, -1);         // it never was in double
    EXPECT_LT(c.residual, accuracy);
    EXPECT_GT(c.smallest_patch_eigenvalue, 0);
    // The forecast is good to a factor of two.
    const auto bytes = static_cast<double>(value_bytes(body.compliance));
    EXPECT_LT(plan.chosen.size_bytes, 2 * bytes);
    EXPECT_GT(plan.chosen.size_bytes, bytes / 2);
}

TEST(HierarchicalCondensation, gives_the_same_bytes_at_any_number_of_threads_that_solve) {
    const DeformableBody body = test::large_block();
    const HierarchicalCompliance one = condense_hierarchically(body, 1e-3, 1, test::no_progress);
    const HierarchicalCompliance again = condense_hierarchically(body, 1e-3, 2, test::no_progress);
    ASSERT_EQ(again.value_count, one.value_count);
    ASSERT_EQ(again.factor_count, one.factor_count);
    EXPECT_EQ(std::memcmp(again.values.get(), one.values.get(), sizeof(float) * one.value_count), 0);
    EXPECT_EQ(std::memcmp(again.factors.get(), one.factors.get(), sizeof(std::int16_t) * one.factor_count),
              0);
}

TEST(HierarchicalCondensation, refuses_an_accuracy_that_its_stored_numbers_do_not_have) {
    DeformableBody body = test::lumpy_block();
    EXPECT_THROW(condense_hierarchically(body, 1e-9, 1, test::no_progress), InvalidInput);
}

}  // namespace
}  // namespace palpate
