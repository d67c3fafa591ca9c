// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <optional>
#include <vector>

#include "runtime/visual/drop_mark.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using collision::CollisionSurface;
using Eigen::Vector3d;
using visual::drop_mark;
using visual::DropMark;

// A ball of 20 mm about the origin.
class DropMarkTest : public testing::Test {
  protected:
    static constexpr double ball = 20, radius = 2, reach = 30;  // mm
    static constexpr double facets = 0.3;  // mm that triangles miss of a round ball, and the mark's lift

    DropMarkTest()
        : mesh_(sample::sphere_surface(Vector3d::Zero(), ball, 4)),
          surface_(mesh_, sample::median_tree(mesh_, 4), "ball") {}

    std::optional<DropMark> mark_of(const Vector3d& tool) const {
        const std::vector<const CollisionSurface*> all{&surface_};
        return drop_mark(all, tool, radius, reach);
    }

    TriangleMesh mesh_;
    CollisionSurface surface_;
};

TEST_F(DropMarkTest, lies_on_the_surface_below_the_tool) {
    const auto mark = mark_of({0, 0, 30});
    ASSERT_TRUE(mark);
    EXPECT_NEAR((mark->foot - Vector3d(0, 0, ball)).norm(), 0, facets);
    EXPECT_NEAR(mark->gap, 30 - ball - radius, facets);
    for (const Vector3d& point : mark->ring) EXPECT_NEAR(point.norm(), ball, facets);
}

TEST_F(DropMarkTest, closes_to_the_tools_own_size_as_it_comes_down) {
    double last = 1e9;
    for (const double height : {40, 30, 25, 23}) {
        const auto mark = mark_of({0, 0, height});
        ASSERT_TRUE(mark);
        const double wide = (mark->ring[0] - mark->ring[DropMark::ring_points / 2]).norm();
        EXPECT_LT(wide, last);
        last = wide;
    }
    EXPECT_NEAR(last, 2 * radius, 1);
}

TEST_F(DropMarkTest, is_not_there_where_the_tool_touches_or_is_inside_or_far) {
    EXPECT_FALSE(mark_of({0, 0, ball + 0.9 * radius}));
    EXPECT_FALSE(mark_of({0, 0, 5}));
    EXPECT_FALSE(mark_of({0, 0, ball + radius + reach + 1}));
    EXPECT_FALSE(drop_mark({}, {0, 0, 30}, radius, reach));
}

}  // namespace
}  // namespace palpate
