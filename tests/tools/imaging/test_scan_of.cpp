// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>

#include "tools/imaging/voxels/scan_of.hpp"

namespace palpate {
namespace {

using namespace imaging;
using Eigen::Vector3d;

// An oblique CT whose value is linear in place, 3 x + 2 y + z in HU: means over blocks are those of places.
float at_place(const Vector3d& p) {
    return static_cast<float>(Vector3d(3, 2, 1).dot(p) - 600);
}

Volume linear_ct(const std::array<std::int32_t, 3>& size, const Vector3d& spacing) {
    Volume volume;
    volume.grid = {.size = size,
                   .spacing = spacing,
                   .origin = {-5, 7, 11},
                   .direction = Eigen::AngleAxisd(0.3, Vector3d(1, -2, 3).normalized()).matrix()};
    for (int k = 0; k < size[2]; ++k)
        for (int j = 0; j < size[1]; ++j)
            for (int i = 0; i < size[0]; ++i)
                volume.values.push_back(at_place(volume.grid.point_of(Vector3d(i, j, k))));
    return volume;
}

Vector3d place_in(const Volume& volume, double i, double j, double k) {
    return volume.grid.point_of(Vector3d(i, j, k));
}

void expect_linear(const Scan& scan) {
    ASSERT_EQ(scan.values.size(), scan.grid.voxel_count());
    const auto& size = scan.grid.size;
    for (int k = 0; k < size[2] - 1; ++k)  // the last block along an axis may be cut
        for (int j = 0; j < size[1] - 1; ++j)
            for (int i = 0; i < size[0] - 1; ++i)
                EXPECT_NEAR(scan.values[scan.grid.offset(i, j, k)],
                            at_place(scan.grid.point_of(Vector3d(i, j, k))), 0.51);
}

TEST(ScanOf, is_the_volumes_part_around_the_points_along_its_own_axes) {
    const Volume volume = linear_ct({60, 50, 40}, {1, 1, 2});
    const std::vector<Vector3d> points{place_in(volume, 20, 15.5, 12), place_in(volume, 30, 18, 14)};
    const auto scan = scan_of(volume, points);
    ASSERT_TRUE(scan);
    EXPECT_TRUE(scan->hounsfield);
    EXPECT_EQ(scan->grid.size, (std::array{31, 24, 13}));  // 10 mm are 10, 10 and 5 voxels
    EXPECT_TRUE(scan->grid.origin.isApprox(place_in(volume, 10, 5, 7), 1e-9));
    EXPECT_EQ(scan->grid.direction, volume.grid.direction);
    expect_linear(*scan);
}

TEST(ScanOf, ends_where_the_volume_does_and_is_none_beside_it) {
    const Volume volume = linear_ct({60, 50, 40}, {1, 1, 2});
    const std::vector<Vector3d> corner{place_in(volume, 58, 1, 39)};
    EXPECT_EQ(scan_of(volume, corner)->grid.size, (std::array{12, 12, 6}));
    const std::vector<Vector3d> beside{place_in(volume, 80, 1, 39)};
    EXPECT_FALSE(scan_of(volume, beside));
}

TEST(ScanOf, takes_means_over_whole_blocks_until_it_fits_in_the_slices_first) {
    const Volume volume = linear_ct({60, 50, 40}, {1, 1, 2});
    const std::vector<Vector3d> all{place_in(volume, 0, 0, 0), place_in(volume, 59, 49, 39)};
    const auto spacing = [&](std::size_t bytes) {
        const Scan scan = *scan_of(volume, all, {.most_bytes = bytes});
        EXPECT_LE(2 * scan.values.size(), bytes);
        expect_linear(scan);
        return scan.grid.spacing;
    };
    EXPECT_EQ(spacing(240'000), Vector3d(1, 1, 2));
    EXPECT_EQ(spacing(239'999), Vector3d(2, 2, 2));
    EXPECT_EQ(spacing(59'999), Vector3d(3, 3, 2));
    EXPECT_EQ(spacing(27'000), Vector3d(3, 3, 4));
}

TEST(ScanOf, has_a_ct_in_hu_however_it_is_stored) {
    Volume volume = linear_ct({20, 20, 20}, {1, 1, 1});
    // As hounsfield_offset() knows it: soft tissue about the offset, air below 14.
    for (std::size_t i = 0; i < volume.values.size(); ++i) volume.values[i] = i % 3 == 0 ? 1.0F : 1040.0F;
    const std::vector<Vector3d> all{place_in(volume, 0, 0, 0), place_in(volume, 19, 19, 19)};
    const auto scan = scan_of(volume, all);
    EXPECT_TRUE(scan->hounsfield);
    EXPECT_EQ(scan->values[0], -999);
    EXPECT_EQ(scan->values[1], 40);
}

TEST(ScanOf, keeps_other_grey_values_where_16_bits_do_and_scales_them_otherwise) {
    Volume volume = linear_ct({20, 20, 20}, {1, 1, 1});
    const std::vector<Vector3d> all{place_in(volume, 0, 0, 0), place_in(volume, 19, 19, 19)};
    const auto stored = [&](float low, float high) {
        for (std::size_t i = 0; i < volume.values.size(); ++i) volume.values[i] = i % 2 == 0 ? low : high;
        const Scan scan = *scan_of(volume, all);
        EXPECT_FALSE(scan.hounsfield);
        return std::pair<int, int>(scan.values[0], scan.values[1]);
    };
    EXPECT_EQ(stored(0, 700), (std::pair{0, 700}));
    EXPECT_EQ(stored(0, 1), (std::pair{0, 4095}));
    EXPECT_EQ(stored(0, 1e6F), (std::pair{0, 4095}));
}

}  // namespace
}  // namespace palpate
