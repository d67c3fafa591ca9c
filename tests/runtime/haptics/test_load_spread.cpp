// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <string>
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

TEST(LocalIndentation, of_a_force_beside_is_what_the_spread_load_lacks) {
    const double modulus = 6.3e-3 / (1 - 0.45 * 0.45), disc = 6;
    for (const double apart : {0.3, 1.5, 4.0, 6.0, 9.0, 20.0}) {
        double integral = 0;
        constexpr double step = 1e-3;
        for (double t = step / 2; t < 60; t += step)
            integral += step * std::pow(48 * ::jn(3, t) / (t * t * t), 2) * ::j0(t * apart / disc);
        const double point = 1 / (std::numbers::pi * modulus * apart);
        EXPECT_NEAR(indentation_beside(apart, modulus, disc),
                    point - integral / (std::numbers::pi * modulus * disc), 0.012 / (modulus * disc))
            << apart;
    }
    EXPECT_EQ(indentation_beside(100, modulus, disc), 0);
}

// What a force gives way by on a cube's top, spread over discs of this reach (mm), on the mean of all places
// in the triangles around its middle, mm/N.
double mean_compliance(const DeformableBody& body, double reach) {
    const std::vector<std::int32_t> blocks = compliance_blocks(body);
    const LoadShares shares = load_shares(body, blocks, reach);
    const auto between = [&](std::int32_t a, std::int32_t b) {
        double sum = 0;
        for (const LoadShare& here : shares.of(a))
            for (const LoadShare& there : shares.of(b))
                sum += static_cast<double>(here.weight * there.weight) *
                       static_cast<double>(
                           compliance_block(body.compliance, blocks[static_cast<std::size_t>(here.vertex)],
                                            blocks[static_cast<std::size_t>(there.vertex)])(2, 2));
        return sum;
    };
    const TriangleMesh& surface = body.boundary.surface;
    double sum = 0;
    int triangles = 0;
    for (const Triangle& t : surface.triangles) {
        const auto corner = [&](std::size_t i) { return surface.vertices[static_cast<std::size_t>(t[i])]; };
        const Vector3d middle = (corner(0) + corner(1) + corner(2)) / 3;
        if ((middle - Vector3d(10, 10, 20)).norm() > 2.5) continue;
        for (std::size_t i = 0; i < 3; ++i)  // the means of w_i w_j over a triangle
            for (std::size_t j = 0; j < 3; ++j) sum += between(t[i], t[j]) / (i == j ? 6 : 12);
        ++triangles;
    }
    return sum / triangles;
}

// What the cube as a whole adds is the same for both discs, but for the wider one's nearness to its sides: 6
// % are measured.
TEST(LoadSpread, a_narrower_disc_gives_way_more_as_its_radius_says) {
    const DeformableBody body = sample::true_elastic_cube(10);
    const SpreadDisc narrow = spread_disc(body, compliance_blocks(body)),
                     wide = widened(narrow, 1.4 * narrow.reach);
    const double more = 0.76654 / surface_contact_modulus(body) * (1 / narrow.radius - 1 / wide.radius);
    const double found = mean_compliance(body, narrow.reach) - mean_compliance(body, wide.reach);
    RecordProperty("found_over_said", std::to_string(found / more));
    EXPECT_NEAR(found, more, 0.08 * more);
}

// A sphere of a quarter to four elements, wherever between nodes: as deep as Hertz has it on a half-space,
// and what the cube as a whole adds: how much more a wide disc, which hardly feels the elements, gives way
// than on a half-space.
TEST(LoadSpread, lets_a_sphere_sink_in_by_hertz_between_nodes_as_on_them) {
    constexpr int cells = 8;
    Case c = soft_cube(cells);
    const DeformableBody& body = c.deformable_bodies.front();
    const double element = 20.0 / cells, modulus = surface_contact_modulus(body);
    const SpreadDisc wide = widened(spread_disc(body, compliance_blocks(body)), 3 * element);
    const double whole = mean_compliance(body, wide.reach) - 0.76654 / (modulus * wide.radius);
    for (const double elements : {0.25, 1.0, 2.0, 4.0}) {
        const double radius = elements * element;
        c.haptics.tool_radius = radius;
        HapticModel model(c);
        for (const double press : {0.4, 1.2}) {
            double least = 1e9, most = 0;
            for (const double x : {9.0, 10.0, 11.3})
                for (const double y : {9.3, 10.0, 11.0}) {
                    model.reset();
                    TickResult result{};
                    for (double depth = -1; depth < press; depth += 0.02)
                        model.tick(held_at({x, y, 20 + radius - depth}), result);
                    model.tick(held_at({x, y, 20 + radius - press}), result);
                    const double force = force_of(result).norm();
                    const double sunk = press - force / model.coupling() - whole * force;
                    const double hertz =
                        4.0 / 3 * modulus * std::sqrt(radius) * std::pow(std::max(sunk, 0.0), 1.5);
                    least = std::min(least, force / hertz);
                    most = std::max(most, force / hertz);
                }
            EXPECT_GT(least, 0.95) << elements << " elements, " << press << " mm deep";
            EXPECT_LT(most, 1.05) << elements << " elements, " << press << " mm deep";
            EXPECT_LT(most / least, 1.03 / 0.97) << elements << " elements, " << press << " mm deep";
            const std::string name = std::to_string(elements) + "_elements_" + std::to_string(press) + "_mm";
            RecordProperty(name, std::to_string(least) + " to " + std::to_string(most));
        }
    }
}

}  // namespace
}  // namespace palpate
