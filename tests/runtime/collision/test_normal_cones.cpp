// SPDX-License-Identifier: Apache-2.0
// The search by normal cones against all pairs of triangles.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "runtime/collision/balls/ball_pairs.hpp"
#include "runtime/collision/cones/cone_pairs.hpp"
#include "runtime/collision/cones/local_minima.hpp"
#include "runtime/collision/tree_pairs.hpp"
#include "tests/runtime/collision/bumpy_ball.hpp"
#include "tests/runtime/samples.hpp"

namespace palpate {
namespace {

using namespace collision;
using Eigen::Vector3d;

class Pairs {
  public:
    Pairs(const TriangleMesh& a, const TriangleMesh& b)
        : features_a_(a.vertices, a.triangles),
          features_b_(b.vertices, b.triangles),
          tree_a_(features_a_),
          tree_b_(features_b_) {}

    std::vector<LocalMinimum> by_cones(const Eigen::Isometry3d& X_BA, double within) {
        std::vector<LocalMinimum> minima;
        looked_at_ = 0;
        const ConeReach reach{within};
        for_each_pair(
            tree_a_, tree_b_,
            [&](const ConeNode& a, const ConeNode& b) { return may_be_nearest(a, X_BA, b, reach); },
            [&](const ConeNode& a, const ConeNode& b) {
                add(X_BA, a.triangle, b.triangle, within, minima);
                return true;
            });
        return minima;
    }
    std::vector<LocalMinimum> by_all(const Eigen::Isometry3d& X_BA, double within) {
        std::vector<LocalMinimum> minima;
        for (std::size_t a = 0; a < features_a_.triangle_count(); ++a)
            for (std::size_t b = 0; b < features_b_.triangle_count(); ++b)
                add(X_BA, static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), within, minima);
        return minima;
    }
    // The least distance of any two triangles, mm.
    double apart(const Eigen::Isometry3d& X_BA) const {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t a = 0; a < features_a_.triangle_count(); ++a)
            for (std::size_t b = 0; b < features_b_.triangle_count(); ++b)
                least = std::min(least, closest_points_of_triangles(placed(X_BA, a), features_b_.corners(b))
                                            .on_a.squared_distance);
        return std::sqrt(least);
    }
    std::size_t minima_of(const Eigen::Isometry3d& X_BA, std::size_t a, std::size_t b, double within) {
        std::vector<LocalMinimum> minima;
        add(X_BA, static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), within, minima);
        return minima.size();
    }
    std::size_t looked_at() const { return looked_at_; }
    const NormalConeTree& tree_a() const { return tree_a_; }
    const NormalConeTree& tree_b() const { return tree_b_; }
    const SurfaceFeatures& features_a() const { return features_a_; }
    const SurfaceFeatures& features_b() const { return features_b_; }

  private:
    TriangleCorners placed(const Eigen::Isometry3d& X_BA, std::size_t a) const {
        TriangleCorners corners = features_a_.corners(a);
        for (Vector3d& corner : corners) corner = X_BA * corner;
        return corners;
    }
    void add(const Eigen::Isometry3d& X_BA, std::int32_t a, std::int32_t b, double within,
             std::vector<LocalMinimum>& minima) {
        ++looked_at_;
        const auto ia = static_cast<std::size_t>(a), ib = static_cast<std::size_t>(b);
        const TriangleCorners of_a = placed(X_BA, ia), of_b = features_b_.corners(ib);
        PairMinima found;
        local_minima({features_a_, features_b_, ia, ib, X_BA, of_a, of_b}, within, found);
        minima.insert(minima.end(), found.minima.begin(),
                      found.minima.begin() + static_cast<std::ptrdiff_t>(found.count));
    }

    SurfaceFeatures features_a_, features_b_;
    NormalConeTree tree_a_, tree_b_;
    std::size_t looked_at_ = 0;
};

std::vector<double> distances_of(const std::vector<LocalMinimum>& minima) {
    std::vector<double> distances;
    for (const LocalMinimum& minimum : minima) distances.push_back(minimum.distance);
    std::ranges::sort(distances);
    return distances;
}

TEST(NormalCones, find_every_local_minimum_that_all_pairs_of_triangles_have) {
    Pairs pairs(bumpy_ball(4, 2, 0.2), bumpy_ball(10, 2, 0.15));
    std::mt19937 random(5);
    std::uniform_real_distribution<double> away(14, 19);
    std::size_t found = 0, looked_at = 0;
    const int poses = samples_of(200);
    for (int pose = 0; pose < poses; ++pose) {
        const Eigen::Isometry3d X_BA = any_placement(away(random), random);
        const std::vector<double> all = distances_of(pairs.by_all(X_BA, 6));
        EXPECT_EQ(distances_of(pairs.by_cones(X_BA, 6)), all) << pose;
        found += all.size();
        looked_at += pairs.looked_at();
        const double apart = pairs.apart(X_BA);
        if (apart > 0 && apart < 6) {
            ASSERT_FALSE(all.empty()) << pose;
            EXPECT_NEAR(all.front(), apart, 1e-9) << pose;
        }
    }
    EXPECT_GT(found, static_cast<std::size_t>(poses));
    // Cones leave out most of 320 x 320 pairs.
    EXPECT_LT(looked_at, static_cast<std::size_t>(poses) * 320 * 320 / 50);
}

// How far points near `at` of a surface are at least beyond the plane through it across d, mm.
double least_beyond(const SurfaceFeatures& features, const Eigen::Isometry3d& X, const Vector3d& at,
                    const Vector3d& d) {
    constexpr double near = 0.2;  // mm
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < features.triangle_count(); ++t) {
        TriangleCorners corners = features.corners(t);
        for (Vector3d& corner : corners) corner = X * corner;
        const TrianglePoint foot = closest_point_on_triangle(at, corners);
        if (foot.squared_distance > 1e-12) continue;
        // From the point a little way towards each corner, along the triangle.
        for (const Vector3d& corner : corners) {
            const Vector3d way = corner - at;
            if (way.norm() > 1e-9) least = std::min(least, d.dot(way) * std::min(1.0, near / way.norm()));
        }
    }
    return least;
}

TEST(NormalCones, the_points_of_a_minimum_are_nearest_to_each_other_along_all_triangles_that_hold_them) {
    Pairs pairs(bumpy_ball(4, 2, 0.2), bumpy_ball(10, 2, 0.15));
    std::mt19937 random(6);
    std::size_t found = 0;
    for (int pose = 0; pose < 20; ++pose) {
        const Eigen::Isometry3d X_BA = any_placement(15.5, random);
        for (const LocalMinimum& minimum : pairs.by_all(X_BA, 6)) {
            ++found;
            EXPECT_NEAR((minimum.on_a - minimum.on_b).norm(), minimum.distance, 1e-12);
            const Vector3d d = (minimum.on_a - minimum.on_b) / minimum.distance;
            EXPECT_GT(least_beyond(pairs.features_a(), X_BA, minimum.on_a, d), -1e-6);
            EXPECT_GT(least_beyond(pairs.features_b(), Eigen::Isometry3d::Identity(), minimum.on_b, -d),
                      -1e-6);
        }
    }
    EXPECT_GT(found, 20u);
}

TEST(NormalCones, a_cone_holds_the_normals_of_its_triangles_and_a_ball_their_corners) {
    Pairs pairs(bumpy_ball(4, 2, 0.2), bumpy_ball(10, 1, 0.15));
    const NormalConeTree& tree = pairs.tree_a();
    std::set<std::int32_t> seen;
    const auto walk = [&](const auto& self, std::int32_t index, std::vector<ConeNode> above) -> void {
        const ConeNode& node = tree.node(index);
        above.push_back(node);
        if (node.left >= 0) {
            self(self, node.left, above);
            self(self, node.left + 1, above);
            return;
        }
        seen.insert(node.triangle);
        const TriangleCorners corners = pairs.features_a().corners(static_cast<std::size_t>(node.triangle));
        const Vector3d normal = unit_normal(corners);
        for (const ConeNode& each : above) {
            const Vector3d axis(each.axis[0], each.axis[1], each.axis[2]),
                centre(each.centre[0], each.centre[1], each.centre[2]);
            EXPECT_GE(axis.dot(normal), each.cosine - 1e-6F);
            for (const Vector3d& corner : corners) EXPECT_LE((corner - centre).norm(), each.radius);
        }
    };
    walk(walk, 0, {});
    EXPECT_EQ(seen.size(), pairs.features_a().triangle_count());
}

TEST(NormalCones, a_surface_moved_within_its_slack_has_no_minimum_that_was_left_out) {
    Pairs pairs(bumpy_ball(4, 1, 0.2), bumpy_ball(10, 2, 0.15));
    std::mt19937 random(7);
    std::uniform_real_distribution<double> part(-1, 1);
    const auto direction = [&] { return Vector3d(part(random), part(random), part(random)).normalized(); };
    const ConeReach wide{3, 0.5, 0.05};
    std::size_t found = 0;
    for (int pose = 0; pose < 50; ++pose) {
        const Eigen::Isometry3d X_BA = any_placement(15.5, random);
        std::set<std::pair<std::int32_t, std::int32_t>> kept;
        for_each_pair(
            pairs.tree_a(), pairs.tree_b(),
            [&](const ConeNode& a, const ConeNode& b) { return may_be_nearest(a, X_BA, b, wide); },
            [&](const ConeNode& a, const ConeNode& b) { return kept.emplace(a.triangle, b.triangle), true; });
        Eigen::Isometry3d moved = X_BA;  // by 0.05 rad about its middle, 0.25 mm of its surface, and 0.2 mm
        moved.linear() = Eigen::AngleAxisd(0.05, direction()) * X_BA.linear();
        moved.translation() += 0.2 * direction();
        for (std::size_t a = 0; a < pairs.features_a().triangle_count(); ++a)
            for (std::size_t b = 0; b < pairs.features_b().triangle_count(); ++b) {
                if (pairs.minima_of(moved, a, b, 3) == 0) continue;
                ++found;
                EXPECT_TRUE(kept.contains({static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)}))
                    << pose;
            }
    }
    EXPECT_GT(found, 30u);
}

}  // namespace
}  // namespace palpate
