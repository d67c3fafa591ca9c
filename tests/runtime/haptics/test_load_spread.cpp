// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "formats/model/contact/compliance_blocks.hpp"
#include "formats/model/contact/local_indentation.hpp"
#include "runtime/haptics/contact/load_spread.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;

const DeformableBody& cube() {
    static const DeformableBody body = sample::true_elastic_cube(6);
    return body;
}

const LoadSpread& spread() {
    static const LoadSpread instance(cube(), compliance_blocks(cube()));
    return instance;
}

// The surface vertex nearest to a place.
std::int32_t vertex_at(const Vector3d& place) {
    const auto& vertices = cube().boundary.surface.vertices;
    const auto nearest =
        std::ranges::min_element(vertices, {}, [&](const Vector3d& v) { return (v - place).norm(); });
    return static_cast<std::int32_t>(nearest - vertices.begin());
}

TEST(LoadSpread, shares_a_force_among_vertices_around_that_give_way_and_keeps_all_of_it_where_all_do) {
    const std::vector<std::int32_t> blocks = compliance_blocks(cube());
    for (std::int32_t v = 0; v < static_cast<std::int32_t>(blocks.size()); ++v) {
        double sum = 0;
        for (const auto& [vertex, weight] : spread().shares(v)) {
            EXPECT_GT(weight, 0);
            EXPECT_GE(blocks[static_cast<std::size_t>(vertex)], 0);
            EXPECT_LT((cube().boundary.surface.vertices[static_cast<std::size_t>(vertex)] -
                       cube().boundary.surface.vertices[static_cast<std::size_t>(v)])
                          .norm(),
                      spread().radius());
            sum += static_cast<double>(weight);
        }
        const double z = cube().boundary.surface.vertices[static_cast<std::size_t>(v)].z();
        if (z > spread().radius())  // the cube is fixed at z = 0
            EXPECT_NEAR(sum, 1, 1e-6);
        else
            EXPECT_LE(sum, 1 + 1e-6);
    }
    const std::int32_t top = vertex_at({10, 10, 20}), bottom = vertex_at({10, 10, 0});
    EXPECT_GT(spread().shares(top).size(), 6U);
    EXPECT_TRUE(spread().shares(bottom).empty());
}

TEST(LoadSpread, compliance_is_that_of_the_shares) {
    const std::vector<std::int32_t> blocks = compliance_blocks(cube());
    const std::int32_t a = vertex_at({10, 10, 20}), b = vertex_at({13, 10, 20}), far = vertex_at({10, 20, 2});
    Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
    for (const auto& here : spread().shares(a))
        for (const auto& there : spread().shares(b))
            expected += static_cast<double>(here.weight * there.weight) *
                        compliance_block(cube().compliance, blocks[static_cast<std::size_t>(here.vertex)],
                                         blocks[static_cast<std::size_t>(there.vertex)])
                            .cast<double>();
    const auto found = spread().near_compliance(a, b);
    ASSERT_TRUE(found);
    EXPECT_EQ(*spread().near_compliance(b, a), found->transpose());
    EXPECT_NEAR((found->cast<double>() - expected).norm(), 0, 1e-5 * expected.norm());
    EXPECT_FALSE(spread().near_compliance(a, far));
}

TEST(LocalIndentation, with_what_the_spread_load_gives_makes_hertz_of_a_light_press) {
    const double modulus = 6.3e-3 / (1 - 0.45 * 0.45), radius = 2, disc = 6;
    // int K² dt by the midpoint rule, K = 48 J3(t) / t³.
    double integral = 0;
    constexpr double step = 1e-3;
    for (double t = step / 2; t < 60; t += step)
        integral += step * std::pow(48 * ::jn(3, t) / (t * t * t), 2);
    for (const double force : {1e-4, 1e-3, 1e-2}) {
        const double hertz = std::cbrt(9 * force * force / (16 * modulus * modulus * radius));
        const double given = integral / (std::numbers::pi * modulus * disc) * force;
        EXPECT_NEAR(local_indentation(force, radius, modulus, disc).depth, hertz - given, 1e-3 * hertz)
            << force;
    }
    double last = 0;
    for (double force = 0.01; force < 3; force += 0.01) {
        const LocalIndentation here = local_indentation(force, radius, modulus, disc);
        EXPECT_GE(here.depth, last);
        EXPECT_NEAR(here.slope,
                    (local_indentation(force + 1e-6, radius, modulus, disc).depth - here.depth) / 1e-6,
                    1e-3 + 1e-3 * here.slope);
        last = here.depth;
    }
    EXPECT_EQ(local_indentation(0, radius, modulus, disc).depth, 0);
}

// A sphere of a quarter to a whole element, wherever between nodes: as deep as Hertz has it on a half-space,
// and what the cube as a whole adds.
TEST(LoadSpread, lets_a_sphere_sink_in_by_hertz_between_nodes_as_on_them) {
    const double modulus = spread().contact_modulus(), element = 20.0 / 6;
    const std::int32_t middle = vertex_at({10, 10, 20});
    const double whole = static_cast<double>((*spread().near_compliance(middle, middle))(2, 2)) -
                         0.76654 / (modulus * spread().radius());
    for (const double radius : {0.25 * element, element}) {
        Case c = soft_cube(6);
        c.haptics.tool_radius = radius;
        double shallowest = 1e9, deepest = 0;
        for (const double x : {9.0, 10.0, 11.3})
            for (const double y : {9.3, 10.0, 11.0}) {
                HapticModel model(c);
                TickResult result{};
                for (double depth = -1; depth < 1.2; depth += 0.02)
                    model.tick(held_at({x, y, 20 + radius - depth}), result);
                const double force = force_of(result).norm();
                const double sunk = 1.2 - 0.02 - force / model.coupling();
                const double hertz = std::cbrt(9 * force * force / (16 * modulus * modulus * radius));
                const double ratio = sunk / (hertz + whole * force);
                shallowest = std::min(shallowest, ratio);
                deepest = std::max(deepest, ratio);
            }
        EXPECT_GT(shallowest, 0.95) << radius;
        EXPECT_LT(deepest, 1.05) << radius;
    }
}

}  // namespace
}  // namespace palpate
