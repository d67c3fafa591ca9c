// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/organs/random_walker.hpp"
#include "tools/imaging/voxels/coarse_grid.hpp"
#include "tools/imaging/voxels/filters.hpp"
#include "tools/imaging/voxels/necks.hpp"

namespace palpate {
namespace {

using namespace imaging;

ImageGrid anisotropic_grid() {
    ImageGrid grid;
    grid.size = {70, 9, 5};  // longer than the lines that are filtered together
    grid.spacing = {0.7, 1.3, 2.5};
    return grid;
}

std::vector<float> random_values(std::size_t count) {
    std::mt19937 generator(3);
    std::normal_distribution<float> value(0, 100);
    std::vector<float> values(count);
    for (float& v : values) v = value(generator);
    return values;
}

TEST(Gaussian, equals_the_weighted_mean_of_the_neighbourhood) {
    const ImageGrid grid = anisotropic_grid();
    const std::vector<float> before = random_values(grid.voxel_count());
    std::vector<float> after = before;
    const double sigma = 2;
    gaussian(grid, after, sigma);
    for (const auto& [i, j, k] :
         {std::array{0, 0, 0}, std::array{35, 4, 2}, std::array{69, 8, 4}, std::array{64, 1, 3}}) {
        double sum = 0, weights = 0;
        for (int z = 0; z < grid.size[2]; ++z)
            for (int y = 0; y < grid.size[1]; ++y)
                for (int x = 0; x < grid.size[0]; ++x) {
                    const Eigen::Array3d voxels(x - i, y - j, z - k);
                    const Eigen::Array3d off = voxels * grid.spacing.array() / sigma;
                    if ((voxels.abs() > (3 * sigma / grid.spacing.array()).ceil()).any()) continue;
                    const double weight = std::exp(-off.square().sum() / 2);
                    sum += weight * before[grid.offset(x, y, z)];
                    weights += weight;
                }
        EXPECT_NEAR(after[grid.offset(i, j, k)], sum / weights, 1e-3) << i;  // float32 sums of values of 100
    }
}

TEST(Gaussian, keeps_a_constant_and_does_not_depend_on_threads) {
    const ImageGrid grid = anisotropic_grid();
    std::vector<float> constant(grid.voxel_count(), 42);
    gaussian(grid, constant, 3);
    for (const float value : constant) ASSERT_NEAR(value, 42, 1e-4);
    const auto run = [&](int threads) {
        set_imaging_threads(threads);
        std::vector<float> values = random_values(grid.voxel_count());
        gaussian(grid, values, 3);
        return values;
    };
    EXPECT_EQ(run(1), run(3));
}

TEST(CoarseGrid, blocks_hold_the_mean_and_lie_where_their_voxels_lie) {
    const ImageGrid grid = anisotropic_grid();
    Volume volume{grid, random_values(grid.voxel_count())};
    const auto block = blocks_of(grid, 2.6);
    EXPECT_EQ(block, (std::array{4, 2, 1}));
    const Volume coarse = coarsen(volume, block);
    EXPECT_EQ(coarse.grid.size, (std::array<std::int32_t, 3>{18, 5, 5}));
    const float mean = (volume.values[grid.offset(68, 8, 4)] + volume.values[grid.offset(69, 8, 4)]) / 2;
    EXPECT_NEAR(coarse.values[coarse.grid.offset(17, 4, 4)], mean, 1e-4);  // a block that the border cuts
    EXPECT_LT((coarse.grid.point_of({1, 1, 1}) - grid.point_of({5.5, 2.5, 1})).norm(), 1e-12);
}

TEST(CoarseGrid, a_cropped_mask_is_put_back_where_it_was) {
    Mask mask{anisotropic_grid(), {}};
    mask.voxels.assign(mask.grid.voxel_count(), 0);
    for (const int i : {20, 21, 25}) mask.voxels[mask.grid.offset(i, 4, 3)] = 1;
    const Box box = bounding_box(mask, 1.4);
    EXPECT_EQ(box.low, (std::array<std::int32_t, 3>{18, 2, 2}));
    EXPECT_EQ(box.size, (std::array<std::int32_t, 3>{10, 5, 3}));
    EXPECT_EQ(refine(crop(mask, box), box.low, {1, 1, 1}, mask.grid).voxels, mask.voxels);
}

TEST(CoarseGrid, refining_blocks_keeps_the_volume_of_a_box_but_for_half_a_block_at_its_border) {
    const ImageGrid grid = [] {
        ImageGrid cube;
        cube.size = {40, 40, 40};
        return cube;
    }();
    Mask blocks{coarse_grid(grid, {2, 2, 2}), {}};
    blocks.voxels.assign(blocks.grid.voxel_count(), 0);
    for (int k = 5; k < 15; ++k)
        for (int j = 5; j < 15; ++j)
            for (int i = 5; i < 15; ++i) blocks.voxels[blocks.grid.offset(i, j, k)] = 1;
    const Mask fine = refine(blocks, {0, 0, 0}, {2, 2, 2}, grid);
    EXPECT_NEAR(static_cast<double>(fine.count()), 8000, 12 * 20 * 2);  // edges are rounded
    EXPECT_EQ(fine.voxels[grid.offset(10, 20, 20)], 1);
    EXPECT_EQ(fine.voxels[grid.offset(9, 20, 20)], 0);
}

// Two balls that a bar joins; the bar's half width is the radius of what passes between them.
TEST(Necks, a_thin_bar_is_cut_and_a_thick_one_is_not) {
    for (const auto& [half_width, joined] : {std::pair{2.0, false}, std::pair{6.0, true}}) {
        Mask mask{ImageGrid{{60, 25, 25}}, {}};
        std::size_t ball = 0;
        for (int k = 0; k < 25; ++k)
            for (int j = 0; j < 25; ++j)
                for (int i = 0; i < 60; ++i) {
                    const Eigen::Vector3d p(i, j, k);
                    const bool left = (p - Eigen::Vector3d(14, 12, 12)).norm() <= 10,
                               right = (p - Eigen::Vector3d(45, 12, 12)).norm() <= 10;
                    const bool bar = i > 14 && i < 45 && std::hypot(j - 12, k - 12) <= half_width;
                    ball += left;
                    mask.voxels.push_back(left || right || bar);
                }
        const std::vector<std::size_t> inside{mask.grid.offset(12, 12, 12)};
        const Mask part = cut_at_necks(mask, depth_in(mask), inside, 0.4);
        EXPECT_EQ(part.voxels[mask.grid.offset(45, 12, 12)] == 1, joined);
        EXPECT_GE(part.count(), ball);
        EXPECT_EQ(part.count() == mask.count(), joined);
    }
}

// A line of voxels 2 mm apart, the first certainly inside and the last certainly outside.
Mask walked(const std::vector<float>& values, double trust_mm, float prior) {
    ImageGrid grid;
    grid.size = {static_cast<std::int32_t>(values.size()), 1, 1};
    grid.spacing = {2, 1, 1};
    Mask inside{grid, std::vector<std::uint8_t>(values.size(), 0)}, outside = inside;
    inside.voxels.front() = outside.voxels.back() = 1;
    return random_walk({grid, values},
                       {inside, outside, std::vector<float>(values.size(), prior), 1, trust_mm});
}

TEST(RandomWalk, divides_an_even_line_in_the_middle_and_another_at_its_step) {
    constexpr double no_trust = 1e6;  // mm
    EXPECT_EQ(walked(std::vector<float>(10, 50), no_trust, 0).count(), 5U);
    EXPECT_EQ(walked({0, 0, 9, 9, 9, 9, 9, 9, 9, 9}, no_trust, 0).count(), 2U);
    EXPECT_EQ(walked({0, 0, 0, 0, 0, 0, 0, 9, 9, 9}, no_trust, 0).count(), 7U);
}

// On an even line the chance u of being inside solves u'' = (u - prior) / trust^2: with trust far below the
// line's length and prior 0 it falls as exp(-x / trust) from the certain end, and is one half at trust ln 2.
TEST(RandomWalk, believes_grey_values_beyond_the_trusted_length) {
    const std::vector<float> even(200, 50);
    for (const double trust_mm : {20.0, 40.0}) {
        const double half_mm = trust_mm * std::log(2.0);
        const auto voxels = static_cast<double>(walked(even, trust_mm, 0).count());
        EXPECT_NEAR(2 * (voxels - 1), half_mm, 2) << trust_mm;  // a voxel
    }
    EXPECT_EQ(walked(even, 20, 1).count() + walked(even, 20, 0).count(), even.size());
}

}  // namespace
}  // namespace palpate
