// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "runtime/collision/collision_surface.hpp"
#include "runtime/collision/neighbourhood.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/collision/collision_scene.hpp"

namespace palpate {
namespace {

using namespace collision;
using Eigen::Vector3d;

constexpr double of_the_way = 1e-9;     // both compute in double; only the order of the pieces differs
constexpr double grazing_error = 1e-6;  // mm, of the touched point where a sphere only grazes
constexpr int sweeps = 10000;
constexpr std::array radii{0.0, 0.2, 1.0};

// A sphere that wanders about `middle` within `reach` (mm), stopped like a tool where it touches: steps of
// 1e-4 mm to 5 mm, and a jump now and then. Returns how many sweeps touched.
int wander(const CollisionSurface& surface, const Vector3d& middle, double reach, double radius) {
    Neighbourhood near;
    std::mt19937 generator(17);
    std::uniform_real_distribution<double> axis(-1, 1), decade(-4, 0.7);
    const auto anywhere = [&] {
        const double x = axis(generator), y = axis(generator), z = axis(generator);
        return Vector3d(x, y, z);
    };
    Vector3d at = middle + reach * anywhere();
    Vector3d heading = anywhere();
    double step = 0.1;
    int touched = 0;
    for (int i = 0; i < sweeps; ++i) {
        if (generator() % 64 == 0) at = middle + reach * anywhere();
        if (generator() % 16 == 0) {
            heading = (middle + 0.8 * reach * anywhere() - at).normalized();
            step = std::pow(10.0, decade(generator));
        }
        const Vector3d to = at + step * heading;
        const auto expected = surface.sweep_sphere(at, to, radius);
        const auto found = near.sweep_sphere(surface, at, to, radius);
        if (i % 3 != 0) near.look_ahead(surface, at, radius);
        EXPECT_EQ(found.has_value(), expected.has_value()) << i << " radius " << radius << " step " << step;
        if (found.has_value() != expected.has_value()) return touched;
        if (!found) {
            at = to;
            continue;
        }
        ++touched;
        EXPECT_EQ(found->fraction, expected->fraction) << i << " radius " << radius;
        // Of several triangles that are touched at once, too.
        EXPECT_EQ(found->slot, expected->slot) << i << " radius " << radius;
        if (found->fraction > 0) {
            EXPECT_NEAR((at + found->fraction * (to - at) - found->point).norm(), radius, grazing_error) << i;
        }
        EXPECT_EQ(found->triangle, surface.mesh_triangle(found->slot));
        EXPECT_NEAR(found->normal.norm(), 1, of_the_way);
        // A tool leans on for some steps, goes on along the surface, or passes through.
        switch (generator() % 4) {
            case 0:
                at = to;
                break;
            case 1:
                heading =
                    (heading - heading.dot(found->normal) * found->normal + 0.01 * anywhere()).normalized();
                break;
            default:
                at += std::max(0.0, found->fraction - 1e-3) * (to - at);
                break;
        }
    }
    return touched;
}

TEST(Neighbourhood, sweeps_like_the_tree_among_awkward_triangles) {
    const Scene scene;
    const CollisionSurface surface(scene.mesh, tilted_tree(scene.mesh, 3), "scene");
    for (const double radius : radii) EXPECT_GT(wander(surface, Scene::middle, 20, radius), sweeps / 50);
}

TEST(Neighbourhood, sweeps_like_the_tree_between_spikes) {
    for (const unsigned seed : {1U, 2U}) {
        const TriangleMesh ball = spiky_ball(seed);
        const CollisionSurface surface(ball, sample::median_tree(ball, 4), "ball");
        for (const double radius : radii)
            EXPECT_GT(wander(surface, Vector3d::Zero(), 15, radius), sweeps / 50);
    }
}

TEST(Neighbourhood, sweeps_like_the_tree_where_triangles_are_finer_than_the_sphere) {
    // 32 768 triangles of 0.1 mm: more in reach than a neighbourhood holds.
    const TriangleMesh fine = sample::sphere_surface({5, -3, 2}, 5, 6);
    const CollisionSurface surface(fine, sample::median_tree(fine, 4), "fine");
    for (const double radius : radii) EXPECT_GT(wander(surface, Vector3d(5, -3, 2), 8, radius), sweeps / 50);
}

TEST(Neighbourhood, sweeps_like_the_tree_far_from_the_surface) {
    const Scene scene;
    const CollisionSurface surface(scene.mesh, tilted_tree(scene.mesh, 3), "scene");
    for (const double radius : radii) wander(surface, Scene::middle, 500, radius);
    wander(surface, Scene::middle + Vector3d(300, 0, 0), 20, 1);
}

TEST(Neighbourhood, stops_at_the_first_of_all_triangles) {
    const Scene scene;
    const CollisionSurface surface(scene.mesh, tilted_tree(scene.mesh, 3), "scene");
    Scene walk;
    for (const double radius : radii) {
        Neighbourhood near;
        Vector3d at = walk.point(), goal = walk.point();
        int touched = 0;
        for (int i = 0; i < sweeps; ++i) {
            if (i % 100 == 0) goal = walk.point();
            // Pressed on, from where it stopped, as far below the surface as a coupling leads.
            const Vector3d to = at + std::min(1.0, i % 2 ? 0.03 : 2 / (goal - at).norm()) * (goal - at);
            double first = 2;
            for (std::int32_t slot = 0; slot < surface.triangle_count(); ++slot)
                if (const auto contact = sweep_sphere_triangle(at, to - at, radius, 1, surface.corners(slot)))
                    first = std::min(first, contact->fraction);
            const auto found = near.sweep_sphere(surface, at, to, radius);
            near.look_ahead(surface, at, radius);
            ASSERT_EQ(found.has_value(), first <= 1) << i << " radius " << radius;
            if (found) {
                ++touched;
                ASSERT_NEAR(found->fraction, first, of_the_way) << i << " radius " << radius;
                at += std::max(0.0, found->fraction - 1e-3) * (to - at) + 2e-3 * found->normal;
            } else {
                at += 0.1 * (to - at);
            }
        }
        EXPECT_GT(touched, sweeps / 50) << radius;
    }
}

TEST(Neighbourhood, keeps_to_the_tree_after_the_radius_changes) {
    const Scene scene;
    const CollisionSurface surface(scene.mesh, tilted_tree(scene.mesh, 3), "scene");
    Scene walk;
    Neighbourhood near;
    int touched = 0;
    for (int i = 0; i < sweeps; ++i) {
        const Vector3d from = walk.awkward_point(surface.corners(i % surface.triangle_count()));
        const Vector3d to = from + (i % 2 ? 1.0 : 0.01) * (walk.point() - from);
        const double radius = radii[static_cast<std::size_t>(i % 3)];
        const auto expected = surface.sweep_sphere(from, to, radius);
        const auto found = near.sweep_sphere(surface, from, to, radius);
        ASSERT_EQ(found.has_value(), expected.has_value()) << i;
        if (!found) continue;
        ++touched;
        ASSERT_NEAR(found->fraction, expected->fraction, of_the_way) << i;
    }
    EXPECT_GT(touched, 500);
}

}  // namespace
}  // namespace palpate
