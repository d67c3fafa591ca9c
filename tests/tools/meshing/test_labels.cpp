// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numeric>

#include "formats/model/errors.hpp"
#include "tests/tools/meshing/phantom.hpp"
#include "tools/meshing/labels/gaussian.hpp"
#include "tools/meshing/labels/region_labels.hpp"
#include "tools/meshing/labels/smoothed_labels.hpp"
#include "tools/meshing/surfaces/surface_gap.hpp"
#include "tools/meshing/tetrahedra/size_field.hpp"
#include "tools/meshing/tetrahedra/surface_seeds.hpp"

namespace palpate {
namespace {

using namespace meshing;

TEST(RegionLabels, cutting_out_keeps_every_voxel_in_its_place) {
    const LabelMap map =
        test::organ_with_lesion(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()).toRotationMatrix());
    const RegionLabels labels = cut_out_regions(map, test::organ_and_lesion, 5);
    EXPECT_EQ(labels.values, (std::vector<std::int32_t>{3, 7}));
    EXPECT_EQ(std::ranges::count(labels.regions, 2), std::ranges::count(map.labels, 7));
    for (std::int32_t k = 0; k < labels.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < labels.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < labels.grid.size[0]; ++i) {
                const std::uint8_t region = labels.regions[labels.grid.offset(i, j, k)];
                if (region == 0) continue;
                const Eigen::Vector3d there =
                    map.grid.index_of(labels.grid.point_of({1.0 * i, 1.0 * j, 1.0 * k}));
                EXPECT_EQ(map.labels[map.grid.offset(static_cast<std::int32_t>(std::lround(there.x())),
                                                     static_cast<std::int32_t>(std::lround(there.y())),
                                                     static_cast<std::int32_t>(std::lround(there.z())))],
                          labels.values[region - 1U]);
            }
}

TEST(RegionLabels, voxels_that_touch_in_an_edge_are_two_components) {
    ImageGrid grid;
    grid.size = {4, 4, 1};
    LabelMap map{grid, std::vector<std::uint16_t>(16, 0), {{1, "a"}}};
    map.labels[grid.offset(1, 1, 0)] = map.labels[grid.offset(2, 2, 0)] = map.labels[grid.offset(3, 2, 0)] =
        1;
    const std::array<std::int32_t, 1> one{1};
    const LabelComponents found = find_components(cut_out_regions(map, one, 2));
    ASSERT_EQ(found.components.size(), 3U);
    EXPECT_EQ(found.components[0].region, 0);  // the margin comes first
    EXPECT_EQ(found.components[1].voxels, 1);
    EXPECT_EQ(found.components[2].voxels, 2);
    EXPECT_LT((found.components[2].centroid - Eigen::Vector3d(2.5, 2, 0)).norm(), 1e-12);
}

TEST(RegionLabels, ring_is_one_component_and_its_hole_belongs_to_the_outside) {
    const LabelMap map = test::paint(test::grid_around({0, 0, 0}, Eigen::Matrix3d::Identity(), {40, 40, 10}),
                                     [](const Eigen::Vector3d& p) {
                                         const double r = p.head<2>().norm();
                                         return r > 8 && r < 13 && std::abs(p.z()) < 3 ? 1 : 0;
                                     },
                                     {{1, "ring"}});
    const std::array<std::int32_t, 1> one{1};
    EXPECT_EQ(find_components(cut_out_regions(map, one, 2)).components.size(), 2U);
}

TEST(RegionLabels, specks_go_to_the_region_that_surrounds_them) {
    LabelMap map = test::organ_with_lesion();
    const auto lesion = std::ranges::count(map.labels, 7);
    const auto set = [&](const Eigen::Vector3d& p, std::uint16_t label) {
        const Eigen::Vector3d index = map.grid.index_of(p);
        map.labels[map.grid.offset(static_cast<std::int32_t>(std::lround(index.x())),
                                   static_cast<std::int32_t>(std::lround(index.y())),
                                   static_cast<std::int32_t>(std::lround(index.z())))] = label;
    };
    set(test::lesion_center, 0);                             // a pinhole in the lesion
    set(test::organ_center - Eigen::Vector3d(14, 0, 0), 7);  // a speck of lesion in the organ
    set(test::organ_center - Eigen::Vector3d(0, 25, 0), 3);  // a speck of organ outside
    RegionLabels labels = cut_out_regions(map, test::organ_and_lesion, 5);
    EXPECT_EQ(absorb_specks(labels, 40), 3);
    EXPECT_EQ(find_components(labels).components.size(), 3U);
    EXPECT_EQ(std::ranges::count(labels.regions, 2), lesion);
    EXPECT_EQ(absorb_specks(labels, 40), 0);
}

TEST(RegionLabels, region_without_voxels_is_refused) {
    const std::array<std::int32_t, 2> absent{3, 4};
    EXPECT_THROW(cut_out_regions(test::organ_with_lesion(), absent, 5), InvalidInput);
}

TEST(Gaussian, point_spreads_to_a_normalised_product_of_gaussians) {
    FloatImage image{{21, 19, 17}, {1.5, 1.0, 0}, std::vector<float>(21 * 19 * 17, 0.0F)};
    const std::size_t middle = (8 * 19 + 9) * 21 + 10;
    image.values[middle] = 1;
    smooth(image);
    const auto sum = std::accumulate(image.values.begin(), image.values.end(), 0.0);
    EXPECT_NEAR(sum, 1, 1e-6);  // float32 sums
    EXPECT_NEAR(image.values[middle + 2] / image.values[middle], std::exp(-0.5 * 4 / 2.25), 1e-6);
    EXPECT_NEAR(image.values[middle + 42] / image.values[middle], std::exp(-0.5 * 4), 1e-6);
    EXPECT_EQ(image.values[middle + 21 * 19], 0);
}

TEST(SmoothedLabels, every_region_keeps_its_voxel_count) {
    const LabelMap map = test::organ_with_lesion();
    const double sigma = 1.4;
    const RegionLabels labels =
        cut_out_regions(map, test::organ_and_lesion, smoothing_margin(map.grid, sigma));
    const SmoothedLabels smoothed(labels, sigma);
    std::array<std::int64_t, 3> before{}, after{};
    for (std::int32_t k = 0; k < labels.grid.size[2] - 1; ++k)
        for (std::int32_t j = 0; j < labels.grid.size[1] - 1; ++j)
            for (std::int32_t i = 0; i < labels.grid.size[0] - 1; ++i) {
                ++before[labels.regions[labels.grid.offset(i, j, k)]];
                ++after[smoothed.region_at(labels.grid.point_of({1.0 * i, 1.0 * j, 1.0 * k}))];
            }
    // Without offsets the lesion would lose 2 sigma² / r² = 9 %.
    for (std::size_t region = 1; region < 3; ++region)
        EXPECT_NEAR(static_cast<double>(after[region]) / static_cast<double>(before[region]), 1, 0.002);
}

TEST(SmoothedLabels, beyond_the_grid_lies_the_outside) {
    const LabelMap map = test::organ_with_lesion();
    const RegionLabels labels = cut_out_regions(map, test::organ_and_lesion, smoothing_margin(map.grid, 1));
    const SmoothedLabels smoothed(labels, 1);
    EXPECT_EQ(smoothed.region_at(test::organ_center + Eigen::Vector3d(500, 0, 0)), 0);
    EXPECT_EQ(smoothed.region_at(test::organ_center - Eigen::Vector3d(0, 0, 500)), 0);
    EXPECT_EQ(smoothed.region_at(test::organ_center - Eigen::Vector3d(10, 0, 0)), 1);
    EXPECT_EQ(smoothed.region_at(test::lesion_center), 2);
}

// A cone with its tip towards +x: smoothing takes most from the tip.
LabelMap cone() {
    return test::paint(test::grid_around({0, 0, 0}, Eigen::Matrix3d::Identity(), {90, 60, 44}),
                       [](const Eigen::Vector3d& p) {
                           const double along = 30 - p.x();
                           return along > 0 && along < 60 && p.tail<2>().norm() < 0.4 * along ? 1 : 0;
                       },
                       {{1, "cone"}});
}

TEST(SmoothedLabels, centroid_of_a_pointed_body_stays) {
    const LabelMap map = cone();
    const std::array<std::int32_t, 1> one{1};
    const double sigma = 2.5;
    const RegionLabels labels = cut_out_regions(map, one, smoothing_margin(map.grid, sigma));
    const SmoothedLabels smoothed(labels, sigma);
    std::array<double, 2> count{}, sum{};
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < labels.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < labels.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < labels.grid.size[0]; ++i, ++offset) {
                const Eigen::Vector3d p = labels.grid.point_of({1.0 * i, 1.0 * j, 1.0 * k});
                if (labels.regions[offset] == 1) {
                    ++count[0];
                    sum[0] += p.x();
                }
                if (smoothed.region_at(p) == 1) {
                    ++count[1];
                    sum[1] += p.x();
                }
            }
    // One offset for the whole surface moves the centroid by 0.09 mm.
    EXPECT_NEAR(sum[1] / count[1], sum[0] / count[0], 0.05);
}

TEST(SmoothedLabels, small_sheet_of_one_voxel_beside_a_large_body_survives) {
    // Under one voxel in a hundred: the body as a whole bears the full Gaussian, which takes the sheet.
    const LabelMap map =
        test::paint(test::grid_around({0, 0, 0}, Eigen::Matrix3d::Identity(), {80, 50, 40}),
                    [](const Eigen::Vector3d& p) {
                        if (std::abs(p.x() - 20) < 0.45 && p.tail<2>().lpNorm<Eigen::Infinity>() < 6)
                            return 5;
                        return (p + Eigen::Vector3d(10, 0, 0)).norm() < 20 ? 5 : 0;
                    },
                    {{5, "ball and sheet"}});
    const std::array<std::int32_t, 1> label{5};
    const double sigma = 1.4;
    const RegionLabels labels = cut_out_regions(map, label, smoothing_margin(map.grid, sigma));
    const SmoothedLabels smoothed(labels, sigma);
    const double x =
        map.grid.point_of(Eigen::Vector3d(std::round(map.grid.index_of({20, 0, 0}).x()), 0, 0)).x();
    for (double y = -4; y <= 4; y += 2) EXPECT_EQ(smoothed.region_at({x, y, 2}), 1) << y;
    EXPECT_EQ(smoothed.region_at({x - 3, 0, 3}), 0);
}

TEST(SurfaceGap, is_the_distance_to_a_ball_along_the_normal) {
    const LabelMap map = test::organ_with_lesion();
    const RegionLabels labels = cut_out_regions(map, test::organ_and_lesion, smoothing_margin(map.grid, 1));
    const SmoothedLabels smoothed(labels, 1);
    const Eigen::Vector3d outwards = Eigen::Vector3d(-1, 0.5, 0.3).normalized();
    const InterfaceSide side{.inner = 1, .outer = 0, .normal = outwards};
    const double voxel = 0.9;
    const auto gap = [&](double radius) {
        return surface_gap(smoothed, side, test::organ_center + radius * outwards, 5);
    };
    EXPECT_NEAR(gap(18).value(), 2, 0.5 * voxel);
    EXPECT_NEAR(gap(21.5).value(), -1.5, 0.5 * voxel);
    EXPECT_FALSE(gap(12).has_value());  // 8 mm off
    EXPECT_FALSE(surface_gap(smoothed, side, test::lesion_center, 5).has_value());
}

TEST(SizeField, finest_of_regions_and_balls_holds) {
    const std::array<LocalSizes, 2> regions{LocalSizes{8, 6, 0.8}, LocalSizes{4, 5, 0.4}};
    SizeField field(regions, 3);
    field.add({{10, 0, 0}, 2, {.cell = 1, .facet = 2}});
    EXPECT_EQ(field.at({0, 0, 0}, 1).cell, 8);
    EXPECT_EQ(field.at({0, 0, 0}, 0, 2).facet, 5);
    EXPECT_EQ(field.at({0, 0, 0}, 1, 2).distance, 0.4);
    EXPECT_EQ(field.at({11.9, 0, 0}, 1).cell, 1);
    EXPECT_EQ(field.at({11.9, 0, 0}, 1).distance, 0.8);
    EXPECT_EQ(field.at({12.1, 0, 0}, 1).cell, 8);
    EXPECT_EQ(field.finest_distance(), 0.4);
    EXPECT_EQ(field.largest_facet(), 6);
}

TEST(SurfaceSeeds, lie_on_every_surface_at_their_distance) {
    const LabelMap map = test::organ_with_lesion();
    const RegionLabels labels = cut_out_regions(map, test::organ_and_lesion, smoothing_margin(map.grid, 1));
    const SmoothedLabels smoothed(labels, 1);
    const std::array<LocalSizes, 2> sizes{LocalSizes{.facet = 4},
                                          LocalSizes{.facet = 4}};  // seeds 6 mm apart
    const std::vector<SurfaceSeed> seeds = scatter_seeds(labels, smoothed, SizeField(sizes, 4));
    std::int64_t on_lesion = 0;
    for (const SurfaceSeed& seed : seeds) {
        if (seed.lower == 1 && seed.upper == 2) {
            ++on_lesion;
            EXPECT_NEAR((seed.position - test::lesion_center).norm(), 6.5, 1);  // a voxel
        }
        for (const SurfaceSeed& other : seeds) {
            if (&other == &seed) continue;
            EXPECT_GT((other.position - seed.position).norm(), 0.6 * 6.4);  // the lesion's own distance
        }
    }
    EXPECT_GE(on_lesion, 12);
    EXPECT_GE(seeds.size() - static_cast<std::size_t>(on_lesion), 80U);
}

}  // namespace
}  // namespace palpate
