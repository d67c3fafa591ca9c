// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "formats/model/errors.hpp"
#include "runtime/visual/bodies/display_copy.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using namespace visual;

const Eigen::Vector3d center(10, -200, 700);
constexpr double radius = 80;  // mm: a head
const Eigen::Vector3d focus = center + Eigen::Vector3d(0, 0, radius);

constexpr double near = 15;  // mm

TriangleMesh head() {
    return sample::sphere_surface(center, radius, 6);  // 32 768 triangles
}

double volume(const TriangleMesh& mesh) {
    double six_volume = 0;
    for (const Triangle& t : mesh.triangles) {
        const auto p = [&](std::size_t i) -> Eigen::Vector3d {
            return mesh.vertices[static_cast<std::size_t>(t[i])] - center;
        };
        six_volume += p(0).cross(p(1)).dot(p(2));
    }
    return six_volume / 6;
}

// Mean edge of triangles at most, or at least, this far from the focus.
double mean_edge(const TriangleMesh& mesh, double from, double to) {
    double sum = 0;
    int count = 0;
    for (const Triangle& t : mesh.triangles) {
        const auto p = [&](std::size_t i) -> const Eigen::Vector3d& {
            return mesh.vertices[static_cast<std::size_t>(t[i])];
        };
        const double distance = (p(0) - focus).norm();
        if (distance < from || distance > to) continue;
        sum += (p(1) - p(0)).norm();
        ++count;
    }
    return sum / count;
}

TEST(DisplayCopy, keeps_to_the_budget) {
    const TriangleMesh surface = head();
    for (const std::int64_t budget : {20'000, 3'000, 200}) {
        const auto count =
            static_cast<std::int64_t>(display_copy(surface, budget, {focus}, near).triangles.size());
        EXPECT_LE(count, budget);
        EXPECT_GE(count, budget / 8);  // no more is thrown away than powers of two make
    }
}

TEST(DisplayCopy, of_less_than_a_body_needs_nothing_is_left) {
    EXPECT_TRUE(display_copy(sample::sphere_surface(Eigen::Vector3d::Zero(), radius, 0), 1, {focus}, near)
                    .triangles.empty());
}

TEST(DisplayCopy, a_surface_within_the_budget_comes_back_as_it_is) {
    const TriangleMesh surface = sample::sphere_surface(center, radius, 3);
    const TriangleMesh copy = display_copy(surface, 512, {focus}, near);
    EXPECT_EQ(copy.triangles, surface.triangles);
    EXPECT_EQ(copy.vertices, surface.vertices);
}

TEST(DisplayCopy, is_fine_near_the_focus_and_coarse_far_from_it) {
    const TriangleMesh surface = head();
    const TriangleMesh copy = display_copy(surface, 6'000, {focus}, near);
    const double original = mean_edge(surface, 0, 15);
    EXPECT_LT(mean_edge(copy, 0, 15), 1.2 * original);
    EXPECT_GT(mean_edge(copy, 100, 200), 2 * original);
}

TEST(DisplayCopy, is_as_fine_along_a_line_as_at_its_ends) {
    const TriangleMesh surface = head();
    const Eigen::Vector3d other_end = center + Eigen::Vector3d(radius, 0, 0);
    const auto near_middle = [](const TriangleMesh& mesh) {
        const Eigen::Vector3d middle = center + Eigen::Vector3d(1, 0, 1).normalized() * radius;
        return std::ranges::count_if(mesh.vertices,
                                     [&](const Eigen::Vector3d& p) { return (p - middle).norm() < 10; });
    };
    const auto whole = near_middle(surface);
    const TriangleMesh along =
        display_copy(surface, 8'000, {focus, focus + radius / 2 * Eigen::Vector3d::UnitX(), other_end}, near);
    EXPECT_GT(near_middle(along), 0.9 * static_cast<double>(whole));
    EXPECT_LT(near_middle(display_copy(surface, 8'000, {focus}, near)), 0.6 * static_cast<double>(whole));
}

TEST(DisplayCopy, stays_a_closed_head_facing_outwards) {
    const double exact = 4 * std::numbers::pi / 3 * radius * radius * radius;
    const double got = volume(display_copy(head(), 6'000, {focus}, near));
    EXPECT_NEAR(got, exact, 0.05 * exact);  // merged vertices lie a little inside a convex surface
}

TEST(DisplayCopy, refuses_an_empty_budget) {
    EXPECT_THROW(display_copy(head(), 0, {focus}, near), InvalidInput);
}

}  // namespace
}  // namespace palpate
