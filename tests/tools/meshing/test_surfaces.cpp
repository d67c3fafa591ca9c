// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "formats/model/errors.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/tools/meshing/phantom.hpp"
#include "tools/meshing/measures/quality.hpp"
#include "tools/meshing/surfaces/overlaps.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"

namespace palpate {
namespace {

using namespace meshing;

// Falls off linearly from the centre: the isosurface 100 is the ball of `radius`.
Volume cone(const Eigen::Matrix3d& direction, double radius) {
    Volume volume;
    volume.grid = test::grid_around(test::organ_center, direction, {50, 48, 36});
    for (std::int32_t k = 0; k < volume.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < volume.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < volume.grid.size[0]; ++i) {
                const double r =
                    (volume.grid.point_of({1.0 * i, 1.0 * j, 1.0 * k}) - test::organ_center).norm();
                volume.values.push_back(static_cast<float>(100 + 10 * (radius - r)));
            }
    return volume;
}

TEST(Isosurface, follows_the_level_in_any_direction_and_faces_outwards) {
    const Eigen::Matrix3d oblique =
        Eigen::AngleAxisd(0.35, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const Eigen::Matrix3d left_handed = Eigen::Vector3d(1, -1, 1).asDiagonal();
    for (const Eigen::Matrix3d& direction :
         {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), oblique, left_handed}) {
        const TriangleMesh surface = isosurface(cone(direction, 15), 100);
        const SurfaceQuality quality = measure(surface);
        EXPECT_TRUE(quality.closed_and_oriented());
        EXPECT_EQ(quality.components, 1);
        // Linear interpolation of |r| along edges of up to 1.4 mm errs by about h² / (8 r) = 0.02 mm.
        for (const Eigen::Vector3d& p : surface.vertices)
            ASSERT_NEAR((p - test::organ_center).norm(), 15, 0.03);
        EXPECT_NEAR(quality.volume / (4.0 / 3 * std::numbers::pi * 15 * 15 * 15), 1, 0.01);
    }
}

TEST(Isosurface, is_closed_at_the_border_of_the_image) {
    const SurfaceQuality quality = measure(isosurface(cone(Eigen::Matrix3d::Identity(), 26), 100));
    EXPECT_TRUE(quality.closed_and_oriented());
}

TEST(Isosurface, voxels_exactly_at_the_level_collapse_no_triangle) {
    Volume volume = cone(Eigen::Matrix3d::Identity(), 15);
    for (float& value : volume.values)
        value = std::round(value / 20) * 20;  // most crossings touch a voxel at 100
    const SurfaceQuality quality = measure(isosurface(volume, 100));
    EXPECT_EQ(quality.degenerate_triangles, 0);
    EXPECT_TRUE(quality.closed_and_oriented());
}

TEST(Isosurface, level_above_every_voxel_is_refused) {
    EXPECT_THROW(isosurface(cone(Eigen::Matrix3d::Identity(), 15), 1000), InvalidInput);
}

TEST(KeepNearLabels, what_is_far_from_the_labels_has_no_surface) {
    Volume volume = cone(Eigen::Matrix3d::Identity(), 6);
    const auto ball_at = [&](const Eigen::Vector3d& center, const Eigen::Vector3d& p) {
        return (p - test::organ_center - center).norm() < 4;
    };
    const Eigen::Vector3d aside(15, 0, 0);
    LabelMap map = test::paint(volume.grid,
                               [&](const Eigen::Vector3d& p) {
                                   return ball_at({0, 0, 0}, p) ? 1 : 0;
                               },
                               {{1, "bone"}});
    for (std::size_t v = 0; v < volume.values.size(); ++v) {
        const auto nx = static_cast<std::size_t>(volume.grid.size[0]), slice = volume.grid.offset(0, 0, 1);
        const Eigen::Vector3d index(static_cast<double>(v % nx), static_cast<double>(v % slice / nx),
                                    static_cast<double>(v / slice));
        if (ball_at(aside, volume.grid.point_of(index))) volume.values[v] = 300;  // the table
    }
    EXPECT_EQ(measure(isosurface(volume, 100)).components, 2);
    const std::array<std::int32_t, 1> bone{1};
    keep_near_labels(volume, map, bone, 3);
    EXPECT_EQ(measure(isosurface(volume, 100)).components, 1);
    map.grid.origin.x() += 1;
    EXPECT_THROW(keep_near_labels(volume, map, bone, 3), InvalidInput);
}

TEST(LabelSurface, keeps_the_volume_of_its_labels) {
    const LabelMap map = test::organ_with_lesion();
    const std::array<std::int32_t, 2> body{3, 7};
    const SurfaceQuality quality = measure(label_surface(map, body));
    EXPECT_TRUE(quality.closed_and_oriented());
    EXPECT_EQ(quality.components, 1);  // the lesion's interface is inside
    const auto voxels = std::ranges::count_if(map.labels, [](std::uint16_t l) { return l == 3 || l == 7; });
    EXPECT_NEAR(quality.volume / (static_cast<double>(voxels) * map.grid.voxel_volume()), 1, 0.005);
    const SurfaceQuality unsmoothed = measure(label_surface(map, body, 0));
    EXPECT_TRUE(unsmoothed.closed_and_oriented());
    EXPECT_NEAR(unsmoothed.volume / quality.volume, 1, 0.05);  // corners of voxels are cut
    const std::array<std::int32_t, 1> absent{9};
    EXPECT_THROW(label_surface(map, absent), InvalidInput);
}

TEST(Pieces, small_ones_or_all_but_the_largest_are_left_out) {
    TriangleMesh two = isosurface(cone(Eigen::Matrix3d::Identity(), 15), 100);
    const std::size_t large = two.triangles.size();
    const TriangleMesh small = isosurface(cone(Eigen::Matrix3d::Identity(), 5), 100);
    const auto shift = static_cast<std::int32_t>(two.vertices.size());
    for (const Eigen::Vector3d& p : small.vertices) two.vertices.push_back(p + Eigen::Vector3d(50, 0, 0));
    for (const Triangle& t : small.triangles)
        two.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    EXPECT_EQ(keep_largest_piece(two).triangles.size(), large);
    EXPECT_EQ(keep_large_pieces(two, 1).triangles.size(), two.triangles.size());
    EXPECT_EQ(keep_large_pieces(two, static_cast<std::int64_t>(small.triangles.size()) + 1).triangles.size(),
              large);
    EXPECT_THROW(keep_large_pieces(two, 1'000'000), InvalidInput);
}

TEST(Decimate, stays_closed_and_close) {
    const TriangleMesh fine = isosurface(cone(Eigen::Matrix3d::Identity(), 15), 100);
    const TriangleMesh coarse = decimate(fine, 1000);
    EXPECT_LE(coarse.triangles.size(), 1000U);
    EXPECT_GE(coarse.triangles.size(), 990U);
    EXPECT_TRUE(measure(coarse).closed_and_oriented());
    EXPECT_NEAR(measure(coarse).volume / measure(fine).volume, 1, 1e-3);
    // A triangle of 4 pi r² / 1000 on a sphere of radius r sags by at most 0.11 mm.
    EXPECT_LT(surface_distance(fine, coarse).maximum, 0.2);
    EXPECT_EQ(decimate(coarse, 2000).triangles, coarse.triangles);
}

TEST(Decimate, keeps_the_distance_asked_for_or_names_the_place_that_does_not) {
    Volume ball = cone(Eigen::Matrix3d::Identity(), 12);
    for (std::int32_t k = 0; k < 16; ++k)  // a thin spine, which costs decimation little to lose
        ball.values[ball.grid.offset(25, 24, k)] = std::max(102.0F, ball.values[ball.grid.offset(25, 24, k)]);
    const TriangleMesh fine = isosurface(ball, 100);
    const double free = surface_distance(fine, decimate(fine, 600)).maximum;
    const Decimation kept = decimate_within(fine, 600, 0.9 * free);
    EXPECT_LE(kept.surface.triangles.size(), 600U);
    EXPECT_LE(kept.distance.maximum, 0.9 * free);
    EXPECT_DOUBLE_EQ(kept.distance.maximum, surface_distance(fine, kept.surface).maximum);
    EXPECT_TRUE(measure(kept.surface).closed_and_oriented());
    try {
        decimate_within(fine, 600, 1e-3);
        FAIL() << "600 triangles cannot do that";
    } catch (const QualityNotMet& error) {
        EXPECT_NE(std::string(error.what()).find("mm off at ("), std::string::npos) << error.what();
    }
}

TEST(Decimate, triangles_that_cannot_be_reached_are_named) {
    const TriangleMesh fine = isosurface(cone(Eigen::Matrix3d::Identity(), 12), 100);
    try {
        decimate_within(fine, 2, 100);
        FAIL() << "no closed surface has 2 triangles";
    } catch (const QualityNotMet& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("2 triangles cannot be reached, "), std::string::npos) << message;
        EXPECT_NE(message.find(" are left"), std::string::npos) << message;
    }
}

TriangleMesh inside_out(TriangleMesh surface) {
    for (Triangle& t : surface.triangles) std::swap(t[1], t[2]);
    return surface;
}

TriangleMesh together(TriangleMesh surface, const TriangleMesh& other) {
    const auto shift = static_cast<std::int32_t>(surface.vertices.size());
    surface.vertices.insert(surface.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const Triangle& t : other.triangles)
        surface.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    return surface;
}

TEST(SelfIntersections, balls_that_overlap_have_them_and_one_ball_has_none) {
    const TriangleMesh one = isosurface(cone(Eigen::Matrix3d::Identity(), 10), 100);
    EXPECT_TRUE(self_intersections(one).empty());
    TriangleMesh other = one;
    for (Eigen::Vector3d& p : other.vertices) p += Eigen::Vector3d(10, 0.3, 0.2);
    EXPECT_GT(self_intersections(together(one, other)).size(), 100U);
}

TEST(Overlap, is_found_where_balls_cut_each_other_or_lie_within_each_other) {
    const auto ball = [](double x, double radius) { return sample::sphere_surface({x, 2, 1}, radius, 2); };
    EXPECT_FALSE(place_of_overlap(ball(0, 10)));
    EXPECT_FALSE(place_of_overlap(together(ball(0, 10), ball(21, 10))));
    EXPECT_TRUE(place_of_overlap(together(ball(0, 10), ball(15, 10))));
    EXPECT_TRUE(place_of_overlap(together(ball(0, 10), ball(0, 10))));
    EXPECT_TRUE(place_of_overlap(together(ball(0, 10), ball(1, 5))));
    EXPECT_TRUE(place_of_overlap(inside_out(ball(0, 10))));
}

TEST(Overlap, is_not_a_cavity_nor_a_ball_within_one) {
    const auto ball = [](double radius) { return sample::sphere_surface({0, 2, 1}, radius, 2); };
    const TriangleMesh shell = together(ball(10), inside_out(ball(8)));
    EXPECT_FALSE(place_of_overlap(shell));
    EXPECT_FALSE(place_of_overlap(together(shell, ball(4))));
    EXPECT_TRUE(place_of_overlap(together(shell, inside_out(ball(4)))));
}

TEST(Overlap, is_not_where_cubes_touch_in_a_corner_or_an_edge) {
    const auto cube = [](double x, double y, double z) {
        TriangleMesh surface = boundary_surface(sample::cube_mesh(2, 10)).surface;
        for (Eigen::Vector3d& p : surface.vertices) p += Eigen::Vector3d(x, y, z);
        return surface;
    };
    EXPECT_FALSE(place_of_overlap(together(cube(0, 0, 0), cube(10, 10, 10))));
    EXPECT_FALSE(place_of_overlap(together(cube(0, 0, 0), cube(10, 10, 0))));
    EXPECT_TRUE(place_of_overlap(together(cube(0, 0, 0), cube(9, 9, 9))));
    EXPECT_TRUE(place_of_overlap(together(cube(0, 0, 0), cube(10, 0, 0))));  // in a face: a crack
}

TEST(Decimate, surface_that_is_no_manifold_is_refused) {
    TriangleMesh fin{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}},
                     {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}};
    EXPECT_THROW(decimate(fin, 2), InvalidInput);
}

TEST(SurfaceDistance, concentric_spheres_are_as_far_apart_as_their_radii) {
    const TriangleMesh inner = isosurface(cone(Eigen::Matrix3d::Identity(), 12), 100);
    const TriangleMesh outer = isosurface(cone(Eigen::Matrix3d::Identity(), 14), 100);
    const SurfaceDistance distance = surface_distance(inner, outer);
    EXPECT_NEAR(distance.mean, 2, 0.05);  // chords sag by some hundredths
    EXPECT_NEAR(distance.percentile_95, 2, 0.05);
    EXPECT_NEAR(distance.maximum, 2, 0.1);
    EXPECT_EQ(surface_distance(inner, inner).maximum, 0);
}

TEST(SurfaceDistance, a_triangle_is_as_far_off_as_the_farthest_of_its_corners) {
    const TriangleMesh ball = isosurface(cone(Eigen::Matrix3d::Identity(), 12), 100);
    TriangleMesh dented = ball;
    const std::int32_t dent = ball.triangles[7][1];
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : ball.vertices) centre += p / static_cast<double>(ball.vertices.size());
    dented.vertices[dent] += (ball.vertices[dent] - centre).normalized();  // 1 mm outwards
    const TriangleDistances distances = triangle_distances(dented, ball);
    const double off = distances.whole.maximum;
    EXPECT_NEAR(off, 1, 0.05);
    for (std::size_t t = 0; t < dented.triangles.size(); ++t)
        if (std::ranges::find(dented.triangles[t], dent) != dented.triangles[t].end())
            EXPECT_EQ(distances.of_triangle[t], off);
        else
            EXPECT_LT(distances.of_triangle[t], 1e-9);
}

TEST(LabelSurface, cube_keeps_its_volume_however_it_is_smoothed) {
    ImageGrid grid;
    grid.size = {30, 30, 30};
    LabelMap map{grid, std::vector<std::uint16_t>(grid.voxel_count(), 0), {{1, "cube"}}};
    for (std::int32_t k = 5; k < 25; ++k)
        for (std::int32_t j = 5; j < 25; ++j)
            for (std::int32_t i = 5; i < 25; ++i) map.labels[grid.offset(i, j, k)] = 1;
    const std::array<std::int32_t, 1> one{1};
    for (const double smoothing : {-1.0, 0.5, 0.1, 0.0})
        EXPECT_NEAR(measure(label_surface(map, one, smoothing)).volume, 8000, 8000 * 0.005) << smoothing;
}

}  // namespace
}  // namespace palpate
