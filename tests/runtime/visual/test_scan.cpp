// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

#include "runtime/visual/scan/scan_plane.hpp"
#include "runtime/visual/scan/scan_sampler.hpp"

namespace palpate {
namespace {

using namespace visual;
using Eigen::Vector3d;

// An oblique scan whose grey value is linear in place: 10 x + 4 y - 6 z + 200.
double value_at(const Vector3d& p) {
    return Vector3d(10, 4, -6).dot(p) + 200;
}

Scan linear_scan() {
    Scan scan;
    scan.grid = {.size = {20, 16, 12},
                 .spacing = {1.5, 2, 2.5},
                 .origin = {-12, -20, -8},
                 .direction = Eigen::AngleAxisd(0.4, Vector3d(2, 1, -1).normalized()).matrix()};
    scan.hounsfield = true;
    for (int k = 0; k < scan.grid.size[2]; ++k)
        for (int j = 0; j < scan.grid.size[1]; ++j)
            for (int i = 0; i < scan.grid.size[0]; ++i)
                scan.values.push_back(
                    static_cast<std::int16_t>(std::lround(value_at(scan.grid.point_of(Vector3d(i, j, k))))));
    return scan;
}

Vector3d place_on(const ScanPlane& plane, double across, double up) {
    return plane.corner + across * plane.width * plane.right + up * plane.height * plane.up;
}

TEST(ScanSlice, goes_through_the_point_and_holds_the_whole_scan) {
    const ImageGrid grid = linear_scan().grid;
    const Vector3d p = grid.point_of(Vector3d(7, 5, 4));
    const std::vector<std::pair<SlicePlane, int>> planes{
        {SlicePlane::axial, 2}, {SlicePlane::coronal, 1}, {SlicePlane::sagittal, 0}};
    for (const auto& [plane, across] : planes) {
        const ScanPlane slice = slice_through(grid, plane, p);
        EXPECT_NEAR(slice.right.dot(slice.up), 0, 1e-12);
        EXPECT_NEAR(place_on(slice, 0.3, 0.8)[across], p[across], 1e-9);
        for (int corner = 0; corner < 8; ++corner) {
            const Vector3d voxel = grid.point_of(Vector3d((corner & 1) * (grid.size[0] - 1),
                                                          (corner >> 1 & 1) * (grid.size[1] - 1),
                                                          (corner >> 2) * (grid.size[2] - 1)));
            for (const auto& [way, length] :
                 {std::pair{slice.right, slice.width}, {slice.up, slice.height}}) {
                const double at = way.dot(voxel - slice.corner);
                EXPECT_GT(at, 0);
                EXPECT_LT(at, length);
            }
        }
    }
}

// As radiologists look at them: the patient's left on the right, anterior or superior up.
TEST(ScanSlice, is_turned_as_radiologists_have_it) {
    const ImageGrid grid = linear_scan().grid;
    const ScanPlane axial = slice_through(grid, SlicePlane::axial, Vector3d::Zero()),
                    coronal = slice_through(grid, SlicePlane::coronal, Vector3d::Zero()),
                    sagittal = slice_through(grid, SlicePlane::sagittal, Vector3d::Zero());
    EXPECT_EQ(axial.right, Vector3d::UnitX());
    EXPECT_EQ(axial.up, -Vector3d::UnitY());
    EXPECT_EQ(coronal.right, Vector3d::UnitX());
    EXPECT_EQ(coronal.up, Vector3d::UnitZ());
    EXPECT_EQ(sagittal.right, Vector3d::UnitY());
    EXPECT_EQ(sagittal.up, Vector3d::UnitZ());
}

TEST(ScanSlice, beyond_the_scan_is_its_outermost_one) {
    ImageGrid grid{.size = {10, 10, 10}};
    EXPECT_EQ(slice_through(grid, SlicePlane::axial, {5, 5, 100}).corner.z(), 9.5);
    EXPECT_EQ(slice_through(grid, SlicePlane::sagittal, {-100, 5, 5}).corner.x(), -0.5);
}

TEST(ScanSlice, is_called_by_its_plane_and_side) {
    const ImageGrid grid{.size = {200, 200, 200}, .origin = {-100, -100, -100}};
    const auto text = [&](SlicePlane plane, const Vector3d& p) {
        return slice_text(plane, slice_through(grid, plane, p));
    };
    EXPECT_EQ(text(SlicePlane::axial, {0, 0, 22}), "axial, 22.0 mm superior");
    EXPECT_EQ(text(SlicePlane::axial, {0, 0, -3.25}), "axial, 3.2 mm inferior");
    EXPECT_EQ(text(SlicePlane::coronal, {0, -33, 0}), "coronal, 33.0 mm anterior");
    EXPECT_EQ(text(SlicePlane::sagittal, {41.5, 0, 0}), "sagittal, 41.5 mm left");
}

TEST(GreyWindow, is_for_soft_tissue_in_a_ct_and_of_percentiles_otherwise) {
    Scan scan = linear_scan();
    EXPECT_EQ(grey_window(scan).black, -160);
    EXPECT_EQ(grey_window(scan).white, 240);
    scan.hounsfield = false;
    scan.values.clear();
    for (int i = 0; i < 1000; ++i)
        scan.values.push_back(static_cast<std::int16_t>(i < 5 ? -9000 : i > 995 ? 30000 : i));
    EXPECT_NEAR(grey_window(scan).black, 10, 1);
    EXPECT_NEAR(grey_window(scan).white, 990, 1);
    scan.values.assign(1000, 7);
    EXPECT_LT(grey_window(scan).black, grey_window(scan).white);
}

TEST(ScanSampler, shows_the_scan_where_it_lies_and_nothing_beyond) {
    constexpr double step = 400.0 / 255;  // HU, of a grey level
    const Scan scan = linear_scan();
    const ScanImage image(scan);
    ScanSampler sampler(image);
    constexpr int columns = 61, rows = 47;
    const Vector3d right = Vector3d(1, 2, 0.5).normalized(), up = Vector3d(-2, 1, 0).normalized(),
                   middle = scan.grid.point_of(Vector3d(10, 8, 6));
    const ScanPlane plane{
        .corner = middle - 20 * right - 15 * up, .right = right, .up = up, .width = 40, .height = 30};
    for (int round = 0; round < 2; ++round) {  // the same sampler serves again and again
        sampler.sample(plane, columns, rows);
        vtkImageData* picture = sampler.picture();
        int inside = 0;
        for (int row = 0; row < rows; ++row)
            for (int column = 0; column < columns; ++column) {
                const Vector3d p = place_on(plane, (column + 0.5) / columns, (row + 0.5) / rows),
                               index = scan.grid.index_of(p);
                const auto* texel = static_cast<unsigned char*>(picture->GetScalarPointer(column, row, 0));
                const Eigen::Array3d last(scan.grid.size[0] - 1, scan.grid.size[1] - 1,
                                          scan.grid.size[2] - 1);
                if ((index.array() > 0).all() && (index.array() < last).all()) {
                    const double grey = std::clamp((value_at(p) + 160) / step, 0.0, 255.0);
                    EXPECT_EQ(texel[3], 255);
                    EXPECT_NEAR(texel[0], grey, 1.6);
                    EXPECT_EQ(texel[1], texel[0]);
                    ++inside;
                } else if ((index.array() < -1).any() || (index.array() > last + 1).any()) {
                    EXPECT_EQ(texel[3], 0);
                }
            }
        EXPECT_GT(inside, 300);
    }
}

TEST(ScanSampler, shows_a_scan_of_a_left_handed_grid_where_it_lies) {
    Scan scan = linear_scan();
    scan.grid.direction.col(2) *= -1;
    for (int k = 0, at = 0; k < scan.grid.size[2]; ++k)
        for (int j = 0; j < scan.grid.size[1]; ++j)
            for (int i = 0; i < scan.grid.size[0]; ++i, ++at)
                scan.values[at] =
                    static_cast<std::int16_t>(std::lround(value_at(scan.grid.point_of(Vector3d(i, j, k)))));
    const ImageGrid& grid = scan.grid;
    const ScanImage image(scan);
    ScanSampler sampler(image);
    const ScanPlane plane{.corner = grid.point_of(Vector3d(10, 8, 5)),
                          .right = Vector3d::UnitX(),
                          .up = Vector3d::UnitZ(),
                          .width = 2,
                          .height = 2};
    sampler.sample(plane, 3, 3);
    const auto* middle = static_cast<unsigned char*>(sampler.picture()->GetScalarPointer(1, 1, 0));
    const double grey = (value_at(place_on(plane, 0.5, 0.5)) + 160) * 255 / 400;
    EXPECT_NEAR(middle[0], std::clamp(grey, 0.0, 255.0), 1.6);
    EXPECT_EQ(middle[3], 255);
}

}  // namespace
}  // namespace palpate
