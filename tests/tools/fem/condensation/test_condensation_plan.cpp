// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/condensation/condensation_plan.hpp"

namespace palpate {
namespace {

using namespace fem;

constexpr double plenty = 0x1p40;  // bytes

CondensationForecast forecast_of(const CondensationPlan& plan, CondensationMethod method) {
    return *std::ranges::find(plan.considered, method, &CondensationForecast::method);
}

CondensationPlan unconstrained(const DeformableBody& body) {
    return plan_condensation(body, {.memory_bytes = plenty, .size_bytes = plenty});
}

std::string refusal(const DeformableBody& body, const CondensationOptions& options) {
    try {
        plan_condensation(body, options);
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "";
}

// A slab of one layer, held below: every free node can be touched.
DeformableBody slab() {
    return prepared_body(
        test::held_block({24, 24, 1}, {24, 24, 1}, {.youngs_modulus = 6e-3, .poissons_ratio = 0.45}));
}

// A block of which only the top can be touched.
DeformableBody block_touched_above() {
    DeformableBody body =
        test::held_block({8, 8, 16}, {8, 8, 16}, {.youngs_modulus = 6e-3, .poissons_ratio = 0.45});
    body.contact_nodes =
        test::nodes_where(body.mesh, [](const Eigen::Vector3d& p) { return p.z() > 16 - 1e-9; });
    return prepared_body(std::move(body));
}

TEST(CondensationPlan, considers_every_method_and_takes_the_faster_exact_one) {
    for (const DeformableBody& body : {slab(), block_touched_above(), test::large_block()}) {
        const CondensationPlan plan = unconstrained(body);
        EXPECT_EQ(plan.considered.size(), 3U);
        const double trailing = forecast_of(plan, CondensationMethod::trailing_block).seconds,
                     solves = forecast_of(plan, CondensationMethod::solves).seconds;
        EXPECT_EQ(plan.chosen.method,
                  trailing <= solves ? CondensationMethod::trailing_block : CondensationMethod::solves);
        EXPECT_GT(std::min(trailing, solves), 0);
        EXPECT_EQ(plan.reason, "exact, and the faster way to it");
    }
}

TEST(CondensationPlan, solves_for_a_body_with_few_nodes_inside) {
    EXPECT_EQ(unconstrained(slab()).chosen.method, CondensationMethod::solves);
}

TEST(CondensationPlan, takes_the_trailing_block_where_the_surface_is_small) {
    EXPECT_EQ(unconstrained(block_touched_above()).chosen.method, CondensationMethod::trailing_block);
}

TEST(CondensationPlan, takes_the_representation_that_is_asked_for) {
    const DeformableBody body = test::large_block();
    const CondensationPlan hierarchical = plan_condensation(
        body, {.representation = Representation::hierarchical, .accuracy = 1e-2, .threads = 2});
    EXPECT_EQ(hierarchical.chosen.method, CondensationMethod::hierarchical);
    EXPECT_EQ(hierarchical.reason, "asked for");
    EXPECT_EQ(hierarchical.accuracy, 1e-2);
    EXPECT_EQ(hierarchical.threads, 2);
    const CondensationPlan dense = plan_condensation(body, {.representation = Representation::dense});
    EXPECT_NE(dense.chosen.method, CondensationMethod::hierarchical);
}

TEST(CondensationPlan, compresses_where_memory_is_too_small_for_an_exact_one) {
    const DeformableBody body = test::large_block();
    const CondensationPlan plan = unconstrained(body);
    const double least_exact = std::min(forecast_of(plan, CondensationMethod::trailing_block).memory_bytes,
                                        forecast_of(plan, CondensationMethod::solves).memory_bytes),
                 hierarchical = forecast_of(plan, CondensationMethod::hierarchical).memory_bytes;
    ASSERT_LT(hierarchical, least_exact);
    const CondensationPlan chosen =
        plan_condensation(body, {.memory_bytes = (least_exact + hierarchical) / 2, .size_bytes = plenty});
    EXPECT_EQ(chosen.chosen.method, CondensationMethod::hierarchical);
    EXPECT_NE(chosen.reason.find("an exact one takes"), std::string::npos) << chosen.reason;
    EXPECT_EQ(plan_condensation(body, {.memory_bytes = least_exact, .size_bytes = plenty}).reason,
              plan.reason);
}

TEST(CondensationPlan, compresses_where_the_size_is_too_small_for_an_exact_one) {
    const DeformableBody body = test::large_block();
    const double size = forecast_of(unconstrained(body), CondensationMethod::solves).size_bytes;
    const auto method = [&](double budget) {
        return plan_condensation(body, {.memory_bytes = plenty, .size_bytes = budget}).chosen.method;
    };
    EXPECT_EQ(method(size - 1), CondensationMethod::hierarchical);
    EXPECT_NE(method(size), CondensationMethod::hierarchical);
}

TEST(CondensationPlan, refuses_what_fits_nowhere_naming_numbers_and_remedies) {
    const DeformableBody body = test::large_block();
    const std::string size = refusal(body, {.memory_bytes = plenty, .size_bytes = 0x1p20});
    for (const char* part : {"block", "697 contact nodes", "at most 1048576 MiB of memory and 1 MiB of size",
                             "hierarchical", "--memory", "--size", "--accuracy", "--contact"})
        EXPECT_NE(size.find(part), std::string::npos) << part << " is not in: " << size;
    const std::string memory = refusal(body, {.memory_bytes = 0x1p20, .size_bytes = plenty});
    EXPECT_NE(memory.find("at most 1 MiB of memory"), std::string::npos) << memory;
    // A dense one that is asked for is not compressed instead.
    const std::string dense = refusal(
        body, {.representation = Representation::dense, .memory_bytes = plenty, .size_bytes = 0x1p20});
    EXPECT_NE(dense.find("17 MiB of size"), std::string::npos) << dense;  // 4 (3 x 697)² bytes
    EXPECT_NE(dense.find("--representation hierarchical"), std::string::npos) << dense;
}

TEST(CondensationPlan, knows_the_size_of_a_dense_compliance) {
    const DeformableBody body = test::lumpy_block();
    const CondensationPlan plan = unconstrained(body);
    const auto bytes = static_cast<double>(value_bytes(condensed_body(body, test::no_progress).compliance));
    EXPECT_EQ(forecast_of(plan, CondensationMethod::trailing_block).size_bytes, bytes);
    EXPECT_EQ(forecast_of(plan, CondensationMethod::solves).size_bytes, bytes);
}

TEST(CondensationPlan, knows_the_size_of_a_hierarchical_compliance_within_a_factor_of_two) {
    const DeformableBody body = test::large_block();
    constexpr double accuracy = 1e-2;
    const CondensationPlan plan =
        plan_condensation(body, {.accuracy = accuracy, .memory_bytes = plenty, .size_bytes = plenty});
    const auto bytes =
        static_cast<double>(value_bytes(condense_hierarchically(body, accuracy, 2, test::no_progress)));
    const double forecast = forecast_of(plan, CondensationMethod::hierarchical).size_bytes;
    EXPECT_LT(forecast, 2 * bytes);
    EXPECT_GT(forecast, bytes / 2);
}

TEST(CondensationPlan, forecasts_no_less_memory_with_more_threads) {
    const DeformableBody body = test::large_block();
    const auto with = [&](int threads) {
        return plan_condensation(body, {.memory_bytes = plenty, .size_bytes = plenty, .threads = threads});
    };
    const CondensationPlan one = with(1), eight = with(8);
    for (std::size_t k = 0; k < one.considered.size(); ++k)
        EXPECT_GE(eight.considered[k].memory_bytes, one.considered[k].memory_bytes);
}

TEST(CondensationPlan, is_carried_out_by_its_method) {
    const DeformableBody body = test::lumpy_block();
    CondensationPlan plan = unconstrained(body);
    for (const CondensationForecast& forecast : plan.considered) {
        plan.chosen = forecast;
        const DeformableBody condensed = condensed_body(body, plan, test::no_progress);
        EXPECT_EQ(std::holds_alternative<HierarchicalCompliance>(condensed.compliance),
                  forecast.method == CondensationMethod::hierarchical);
        EXPECT_LT(condensed.certificate.load_error, 1e-3) << name_of(forecast.method);
    }
}

}  // namespace
}  // namespace palpate
