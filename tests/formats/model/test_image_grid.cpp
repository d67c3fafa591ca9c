// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "formats/model/image_grid.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double round_off = 1e-12;  // of doubles of the size of a body in mm

ImageGrid oblique() {
    return {.size = {4, 5, 6},
            .spacing = {0.5, 2, 3},
            .origin = {-10, 20, 30},
            .direction = Eigen::AngleAxisd(0.7, Vector3d(1, -2, 3).normalized()).matrix()};
}

TEST(ImageGrid, voxels_are_counted_and_i_runs_fastest) {
    const ImageGrid grid = oblique();
    EXPECT_EQ(grid.voxel_count(), 120U);
    EXPECT_EQ(grid.voxel_volume(), 3);
    std::size_t expected = 0;
    for (std::int32_t k = 0; k < 6; ++k)
        for (std::int32_t j = 0; j < 5; ++j)
            for (std::int32_t i = 0; i < 4; ++i) {
                EXPECT_TRUE(grid.contains(i, j, k));
                EXPECT_EQ(grid.offset(i, j, k), expected++);
            }
    EXPECT_FALSE(grid.contains(4, 0, 0));
    EXPECT_FALSE(grid.contains(0, 5, 0));
    EXPECT_FALSE(grid.contains(0, 0, 6));
    EXPECT_FALSE(grid.contains(-1, 0, 0));
}

TEST(ImageGrid, places_are_voxels_centres_along_its_directions_and_back) {
    ImageGrid grid = oblique();
    EXPECT_EQ(grid.point_of(Vector3d::Zero()), grid.origin);
    const Vector3d index(1.5, -2, 4);
    EXPECT_LT((grid.index_of(grid.point_of(index)) - index).norm(), round_off * 100);
    grid.direction << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // i along +y, j along -x
    EXPECT_EQ(grid.point_of({2, 1, 1}), Vector3d(-10 - 2, 20 + 1, 30 + 3));
    EXPECT_EQ(grid.index_of({-12, 21, 33}), Vector3d(2, 1, 1));
}

TEST(ImageGrid, is_the_same_if_every_corner_is_within_a_ten_thousandth_of_a_millimetre) {
    const ImageGrid grid = oblique();
    EXPECT_TRUE(same_grid(grid, grid));
    const auto same_after = [&](const auto& change) {
        ImageGrid other = grid;
        change(other);
        return same_grid(grid, other);
    };
    EXPECT_TRUE(same_after([](ImageGrid& g) { g.origin.x() += 0.9e-4; }));
    EXPECT_FALSE(same_after([](ImageGrid& g) { g.origin.x() += 1.1e-4; }));
    // Of six voxels along k the far corner is off by six times as much.
    EXPECT_TRUE(same_after([](ImageGrid& g) { g.spacing.z() += 0.9e-4 / 6; }));
    EXPECT_FALSE(same_after([](ImageGrid& g) { g.spacing.z() += 1.1e-4 / 6; }));
    EXPECT_FALSE(same_after([](ImageGrid& g) { g.direction.col(1) *= -1; }));
    EXPECT_FALSE(same_after([](ImageGrid& g) { g.size[2] = 5; }));
}

}  // namespace
}  // namespace palpate
