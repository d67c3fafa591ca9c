// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <utility>

#include "runtime/visual/hand/surface_under.hpp"
#include "runtime/visual/inside/passage_sight.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using namespace visual;
using collision::CollisionSurface;
using Eigen::Vector3d;

// The inside of an ellipsoid about the origin, its wall looking inwards.
class Cavity {
  public:
    explicit Cavity(const Vector3d& half_axes)
        : mesh_(sample::sphere_surface(Vector3d::Zero(), 1, 4)), surface_(made(half_axes)) {}

    std::optional<Sight> sight(const Vector3d& point, const Vector3d& normal) const {
        const CollisionSurface* const surfaces[]{&surface_};
        return choose_passage_sight(surfaces, point, normal);
    }
    bool sees(const Sight& sight) const {
        const CollisionSurface* const surfaces[]{&surface_};
        const Vector3d eye = sight.eye();
        return !is_blocked(surfaces, eye, sight.target + 0.05 * (eye - sight.target), 0);
    }
    double room(const Vector3d& place) const { return surface_.closest_point(place, 1000)->distance; }

  private:
    CollisionSurface made(const Vector3d& half_axes) {
        for (Vector3d& p : mesh_.vertices) p = p.cwiseProduct(half_axes);
        for (Triangle& t : mesh_.triangles) std::swap(t[0], t[1]);
        return {mesh_, sample::median_tree(mesh_, 4), "cavity"};
    }

    TriangleMesh mesh_;
    CollisionSurface surface_;
};

double angle_deg(const Vector3d& a, const Vector3d& b) {
    return std::acos(a.normalized().dot(b.normalized())) * 180 / std::numbers::pi;
}

TEST(PassageSight, looks_along_a_passage_at_its_end) {
    const Cavity passage({9, 9, 40});
    const auto sight = passage.sight({0, 0, -40}, Vector3d::UnitZ());
    ASSERT_TRUE(sight);
    EXPECT_LT(angle_deg(sight->toward_eye, Vector3d::UnitZ()), 10);
    EXPECT_GT((sight->eye() - sight->target).norm(), 30);
    EXPECT_TRUE(passage.sees(*sight));
    EXPECT_GT(passage.room(sight->eye()), 5);
    EXPECT_FALSE(sight->blocked);
    EXPECT_GT(sight->view_angle_deg, 60);
}

TEST(PassageSight, looks_along_a_passage_at_its_side) {
    const Cavity passage({6, 6, 40});
    const auto sight = passage.sight({6, 0, 0}, -Vector3d::UnitX());
    ASSERT_TRUE(sight);
    EXPECT_GT(std::abs(sight->toward_eye.z()), 0.8);
    EXPECT_TRUE(passage.sees(*sight));
}

TEST(PassageSight, a_narrow_hollow_has_none) {
    EXPECT_FALSE(Cavity({6, 6, 6}).sight({0, 0, -6}, Vector3d::UnitZ()));
}

TEST(PassageSight, looks_closely_along_the_line_of_sight) {
    const auto sight = Cavity({9, 9, 40}).sight({0, 0, -40}, Vector3d::UnitZ());
    ASSERT_TRUE(sight);
    ASSERT_EQ(sight->close_up.size(), 2U);
    EXPECT_NEAR((sight->close_up.front() - sight->eye()).norm(), 0, 1e-9);
    EXPECT_EQ(sight->close_up.back(), sight->target);
}

}  // namespace
}  // namespace palpate
