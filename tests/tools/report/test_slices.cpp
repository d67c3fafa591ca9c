// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>

#include "tests/formats/sample_case.hpp"
#include "tools/report/pictures/slices.hpp"

namespace palpate {
namespace {

using namespace report;

const Eigen::Vector3d middle(10, -20, 30);

ImageGrid straight_grid() {
    return {.size = {61, 61, 61}, .spacing = {1, 1, 1}, .origin = middle - Eigen::Vector3d::Constant(30)};
}

// About the same middle, index axes flipped and turned.
ImageGrid oblique_grid() {
    ImageGrid grid{.size = {81, 71, 91}, .spacing = {0.9, 1.1, 0.8}};
    grid.direction = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix() *
                     Eigen::Vector3d(-1, -1, 1).asDiagonal();
    grid.origin = middle - grid.direction * grid.spacing.cwiseProduct(Eigen::Vector3d(40, 35, 45));
    return grid;
}

// A linear ramp: trilinear interpolation reproduces it on any grid.
Volume ramp(const ImageGrid& grid, const Eigen::Vector3d& slope) {
    Volume volume{.grid = grid, .values = std::vector<float>(grid.voxel_count())};
    for (std::int32_t k = 0; k < grid.size[2]; ++k)
        for (std::int32_t j = 0; j < grid.size[1]; ++j)
            for (std::int32_t i = 0; i < grid.size[0]; ++i)
                volume.values[grid.offset(i, j, k)] =
                    static_cast<float>(slope.dot(grid.point_of(Eigen::Vector3d(i, j, k)) - middle));
    return volume;
}

LabelMap ball(const ImageGrid& grid, double radius) {
    LabelMap map{.grid = grid, .labels = std::vector<std::uint16_t>(grid.voxel_count()), .names = {}};
    map.names = {{.value = 3, .name = "ball", .colour = {1, 0, 0}}};
    for (std::int32_t k = 0; k < grid.size[2]; ++k)
        for (std::int32_t j = 0; j < grid.size[1]; ++j)
            for (std::int32_t i = 0; i < grid.size[0]; ++i)
                if ((grid.point_of(Eigen::Vector3d(i, j, k)) - middle).norm() < radius)
                    map.labels[grid.offset(i, j, k)] = 3;
    return map;
}

SliceWindow window(Plane plane) {
    return {.plane = plane, .center = middle, .side = 40, .pixels = 80};
}

int red(const Picture& picture, int x, int y) {
    return picture.rgb[picture.offset(x, y)];
}

TEST(Slices, patients_right_is_at_the_left_and_the_front_on_top_of_an_axial_picture) {
    const Volume to_left = ramp(straight_grid(), {1, 0, 0}), to_back = ramp(straight_grid(), {0, 1, 0});
    const Picture x = slice_picture(window(Plane::axial), &to_left, nullptr);
    const Picture y = slice_picture(window(Plane::axial), &to_back, nullptr);
    EXPECT_LT(red(x, 5, 40), red(x, 75, 40));
    EXPECT_LT(red(y, 40, 5), red(y, 40, 75));
}

TEST(Slices, head_is_on_top_of_coronal_and_sagittal_pictures) {
    const Volume up = ramp(straight_grid(), {0, 0, 1}), to_back = ramp(straight_grid(), {0, 1, 0});
    const Volume to_left = ramp(straight_grid(), {1, 0, 0});
    for (const Plane plane : {Plane::coronal, Plane::sagittal}) {
        const Picture z = slice_picture(window(plane), &up, nullptr);
        EXPECT_GT(red(z, 40, 5), red(z, 40, 75));
    }
    const Picture front = slice_picture(window(Plane::sagittal), &to_back, nullptr);
    EXPECT_LT(red(front, 5, 40), red(front, 75, 40));
    const Picture right = slice_picture(window(Plane::coronal), &to_left, nullptr);
    EXPECT_LT(red(right, 5, 40), red(right, 75, 40));
}

TEST(Slices, an_oblique_flipped_grid_gives_the_picture_of_a_straight_one) {
    const auto map = [](const ImageGrid& grid) {
        Volume volume = ramp(grid, {3, 2, 1});
        volume.values.front() = -1000;  // a CT: fixed grey window
        return slice_picture(window(Plane::coronal), &volume, nullptr);
    };
    const Picture straight = map(straight_grid()), oblique = map(oblique_grid());
    for (std::size_t i = 0; i < straight.rgb.size(); ++i)
        ASSERT_LE(std::abs(straight.rgb[i] - oblique.rgb[i]), 1) << "byte " << i;
}

TEST(Slices, a_label_is_tinted_inside_and_contoured_at_its_rim) {
    const LabelMap map = ball(oblique_grid(), 12);
    const Picture picture = slice_picture(window(Plane::axial), nullptr, &map);
    // Twelve mm are 24 pixels; the rim in full colour lies within a voxel of that.
    int rim = -1;
    for (int x = 40; x < 80; ++x)
        if (red(picture, x, 40) == 255) rim = x;
    EXPECT_NEAR(rim, 64, 2);
    EXPECT_GT(red(picture, 40, 40), red(picture, 78, 40));
    EXPECT_LT(red(picture, 40, 40), 255);
    EXPECT_EQ(picture.rgb[picture.offset(78, 40)], picture.rgb[picture.offset(78, 40) + 2]);
}

TEST(Slices, beyond_the_image_is_black) {
    const Volume volume = ramp(straight_grid(), {1, 0, 0});
    SliceWindow wide = window(Plane::axial);
    wide.side = 200;
    EXPECT_EQ(red(slice_picture(wide, &volume, nullptr), 79, 40), 0);
}

TEST(Slices, outline_of_a_sphere_is_a_circle) {
    const double radius = 15, height = 5;
    const TriangleMesh sphere = sample::sphere_surface(middle + Eigen::Vector3d(0, 0, height), radius, 5);
    const auto segments = slice_outline(window(Plane::axial), sphere);
    ASSERT_GT(segments.size(), 100U);
    const double expected = std::sqrt(radius * radius - height * height) * 80 / 40;  // pixels
    for (const auto& [a, b] : segments) {
        EXPECT_NEAR((a - Eigen::Vector2d(40, 40)).norm(), expected, 0.1);
        EXPECT_NEAR((b - Eigen::Vector2d(40, 40)).norm(), expected, 0.1);
    }
}

}  // namespace
}  // namespace palpate
