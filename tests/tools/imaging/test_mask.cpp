// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/voxels/mask.hpp"

namespace palpate {
namespace {

using namespace imaging;

// Anisotropic and oblique, so that voxel distances and millimetres differ in every way.
ImageGrid oblique_grid() {
    ImageGrid grid;
    grid.size = {11, 9, 7};
    grid.spacing = {0.8, 1.1, 2.5};
    grid.direction = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
    return grid;
}

Mask random_mask(double density, unsigned seed) {
    Mask mask{oblique_grid(), {}};
    std::mt19937 generator(seed);
    std::bernoulli_distribution inside(density);
    for (std::size_t i = 0; i < mask.grid.voxel_count(); ++i) mask.voxels.push_back(inside(generator));
    return mask;
}

std::vector<Eigen::Vector3d> centers_of(const Mask& mask, std::uint8_t value) {
    std::vector<Eigen::Vector3d> centers;
    std::size_t offset = 0;
    for (int k = 0; k < mask.grid.size[2]; ++k)
        for (int j = 0; j < mask.grid.size[1]; ++j)
            for (int i = 0; i < mask.grid.size[0]; ++i)
                if (mask.voxels[offset++] == value)
                    centers.push_back(mask.grid.point_of(Eigen::Vector3d(i, j, k)));
    return centers;
}

Mask all_inside() {
    Mask mask{oblique_grid(), {}};
    mask.voxels.assign(mask.grid.voxel_count(), 1);
    return mask;
}

TEST(Mask, distances_equal_those_of_brute_force_in_millimetres) {
    const Mask mask = random_mask(0.02, 1);
    ASSERT_GT(mask.count(), 3U);
    const std::vector<Eigen::Vector3d> targets = centers_of(mask, 1);
    const std::vector<Eigen::Vector3d> all = centers_of(all_inside(), 1);
    const std::vector<float> distances = distance_to(mask);
    for (std::size_t i = 0; i < all.size(); ++i) {
        double nearest = INFINITY;
        for (const Eigen::Vector3d& target : targets) nearest = std::min(nearest, (target - all[i]).norm());
        ASSERT_NEAR(distances[i], nearest, 1e-4) << i;  // float32 in the filter
    }
}

TEST(Mask, distance_to_nothing_is_infinite) {
    const Mask nothing{oblique_grid(), std::vector<std::uint8_t>(oblique_grid().voxel_count(), 0)};
    EXPECT_TRUE(std::isinf(distance_to(nothing).front()));
    EXPECT_EQ(dilate(nothing, 3).count(), 0U);
}

TEST(Mask, opening_shrinks_closing_grows_and_both_are_idempotent) {
    for (const unsigned seed : {1U, 2U, 3U}) {
        const Mask mask = random_mask(0.6, seed);
        const double radius = 1.2;
        const Mask opened = open(mask, radius), closed = close(mask, radius);
        EXPECT_EQ(subtract(opened, mask).count(), 0U);
        EXPECT_EQ(subtract(mask, closed).count(), 0U);
        EXPECT_EQ(open(opened, radius).voxels, opened.voxels);
        EXPECT_EQ(close(closed, radius).voxels, closed.voxels);
        EXPECT_NE(opened.voxels, closed.voxels);
    }
}

TEST(Mask, what_the_border_cuts_is_not_eroded_from_outside) {
    EXPECT_EQ(erode(all_inside(), 2).count(), all_inside().count());
}

TEST(Mask, a_dilated_voxel_is_a_ball_in_millimetres) {
    Mask mask{oblique_grid(), std::vector<std::uint8_t>(oblique_grid().voxel_count(), 0)};
    mask.voxels[mask.grid.offset(5, 4, 3)] = 1;
    const Eigen::Vector3d center = mask.grid.point_of({5, 4, 3});
    const double radius = 2.5;  // one step along k exactly
    const Region ball{{{center, radius + 1e-9}}, {}};
    EXPECT_EQ(dilate(mask, radius).voxels, clip(all_inside(), ball).voxels);
}

TEST(Mask, components_join_by_faces_and_are_numbered_by_size) {
    Mask mask{oblique_grid(), std::vector<std::uint8_t>(oblique_grid().voxel_count(), 0)};
    const auto set = [&](int i, int j, int k) { mask.voxels[mask.grid.offset(i, j, k)] = 1; };
    set(0, 0, 0);
    set(1, 1, 0);  // meets the first by an edge only
    set(1, 1, 1);
    set(6, 6, 6);
    const Components pieces = components_of(mask);
    EXPECT_EQ(pieces.sizes, (std::vector<std::size_t>{2, 1, 1}));
    EXPECT_EQ(pieces.labels[mask.grid.offset(1, 1, 1)], 1U);
    EXPECT_EQ(pieces.labels[mask.grid.offset(0, 0, 0)], 2U);
    EXPECT_EQ(keep_largest(mask).count(), 2U);
    EXPECT_EQ(drop_small(mask, 1.5 * mask.grid.voxel_volume()).count(), 2U);
    EXPECT_EQ(keep_largest(subtract(mask, mask)).count(), 0U);
}

TEST(Mask, only_enclosed_holes_are_filled) {
    Mask mask = all_inside();
    mask.voxels[mask.grid.offset(5, 4, 3)] = 0;  // enclosed
    mask.voxels[mask.grid.offset(2, 2, 0)] = 0;  // open at the border
    const Mask filled = fill_holes(mask);
    EXPECT_EQ(filled.count(), mask.count() + 1);
    EXPECT_EQ(filled.voxels[mask.grid.offset(2, 2, 0)], 0);
}

TEST(Mask, smoothing_keeps_the_volume_and_rounds_corners_off) {
    Mask cube{ImageGrid{{20, 20, 20}}, std::vector<std::uint8_t>(8000, 0)};
    for (int k = 5; k < 15; ++k)
        for (int j = 5; j < 15; ++j)
            for (int i = 5; i < 15; ++i) cube.voxels[cube.grid.offset(i, j, k)] = 1;
    const Mask round = smooth(cube, 4);
    // Voxels of equal mean are kept or dropped together: eight corners at most, by symmetry in threes.
    EXPECT_NEAR(static_cast<double>(round.count()), 1000, 48);
    EXPECT_EQ(round.voxels[cube.grid.offset(5, 5, 5)], 0);
    EXPECT_EQ(round.voxels[cube.grid.offset(4, 9, 9)], 1);
    EXPECT_EQ(smooth(cube, 0).voxels, cube.voxels);
}

TEST(Mask, results_do_not_depend_on_the_number_of_threads) {
    const Mask mask = random_mask(0.4, 7);
    const auto run = [&](int threads) {
        set_imaging_threads(threads);
        return std::tuple(components_of(mask).labels, distance_to(mask), open(mask, 1.2).voxels);
    };
    const auto alone = run(1);
    EXPECT_EQ(run(2), alone);
    EXPECT_EQ(run(5), alone);
}

TEST(Mask, only_voxels_of_the_grid_are_looked_at_however_small_they_are) {
    ImageGrid grid;
    grid.size = {4, 3, 2};
    grid.spacing = {1e-9, 1e-9, 1e-9};
    const IndexBox all = voxels_around(grid, {0, 0, 0}, 100);
    EXPECT_TRUE((all.low == Eigen::Array3i(0, 0, 0)).all());
    EXPECT_TRUE((all.high == Eigen::Array3i(3, 2, 1)).all());
    const IndexBox none = voxels_around(grid, {1e6, 0, 0}, 100);
    EXPECT_GT(none.low[0], none.high[0]);
    grid.spacing = {1, 1, 1};
    const IndexBox part = voxels_around(grid, {2, 1, 0}, 1.2);
    EXPECT_TRUE((part.low == Eigen::Array3i(1, 0, 0)).all());
    EXPECT_TRUE((part.high == Eigen::Array3i(3, 2, 1)).all());
}

}  // namespace
}  // namespace palpate
