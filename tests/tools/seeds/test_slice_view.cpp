// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "tools/seeds/layout.hpp"
#include "tools/seeds/slice_view.hpp"

namespace palpate {
namespace {

using namespace seeds;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double exact = 1e-9;  // mm: rounding only

// All 48 ways to flip and permute the axes, each also turned by 20 degrees about (1, 2, 3).
std::vector<ImageGrid> grids() {
    std::vector<ImageGrid> grids;
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.35, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    std::array<int, 3> axes{0, 1, 2};
    do {
        for (int flips = 0; flips < 8; ++flips)
            for (const bool turned : {false, true}) {
                ImageGrid grid{.size = {40, 50, 60}, .spacing = {1.5, 0.8, 2.5}, .origin = {7, -90, 30}};
                for (int i = 0; i < 3; ++i)
                    grid.direction.col(i) =
                        (flips >> i & 1 ? -1 : 1) * Vector3d::Unit(axes[static_cast<std::size_t>(i)]);
                if (turned) grid.direction = turn * grid.direction;
                grids.push_back(grid);
            }
    } while (std::ranges::next_permutation(axes).found);
    return grids;
}

Vector3d at(const SliceView& view, const ImageGrid& grid, const Vector2d& point) {
    return grid.point_of(index_at(view, grid, 12, point).value());
}

TEST(SliceView, places_right_front_and_head_radiologically_in_every_orientation) {
    const std::vector<ImageGrid> all = grids();
    ASSERT_EQ(all.size(), 96U);
    const Vector3d left = Vector3d::UnitX(), back = Vector3d::UnitY(), feet = -Vector3d::UnitZ();
    const std::array<std::array<Vector3d, 2>, 3> right_and_down{{{left, back}, {left, feet}, {back, feet}}};
    const std::array<std::string, 3> names{"axial", "coronal", "sagittal"};
    const std::array<std::string, 3> edges{"RLAP", "RLSI", "APSI"};
    const double nearly = 0.9;  // cosine of the turn of 20 degrees, less a little
    for (const ImageGrid& grid : all) {
        const auto views = slice_views(grid);
        for (std::size_t n = 0; n < 3; ++n) {
            const Vector3d start = at(views[n], grid, {10, 10});
            EXPECT_GT((at(views[n], grid, {11, 10}) - start).dot(right_and_down[n][0]), nearly);
            EXPECT_GT((at(views[n], grid, {10, 11}) - start).dot(right_and_down[n][1]), nearly);
            EXPECT_EQ(views[n].name, names[n]);
            EXPECT_EQ(std::string(views[n].edges.data(), 4), edges[n]);
        }
    }
}

TEST(SliceView, maps_millimetres_on_the_screen_to_millimetres_in_the_patient) {
    for (const ImageGrid& grid : grids())
        for (const SliceView& view : slice_views(grid)) {
            const Vector2d a(3, 5), b(15, 21);
            EXPECT_NEAR((at(view, grid, a) - at(view, grid, b)).norm(), (a - b).norm(), exact);
            EXPECT_NEAR((pane_point(view, grid, *index_at(view, grid, 12, b)) - b).norm(), 0, exact);
            EXPECT_NEAR(index_at(view, grid, 12, b).value()[view.across], 12, exact);
        }
}

TEST(SliceView, counts_slices_away_from_the_viewer) {
    // Seen from the feet, the front and the left side.
    const std::array<Vector3d, 3> away{Vector3d::UnitZ(), Vector3d::UnitY(), -Vector3d::UnitX()};
    for (const ImageGrid& grid : grids()) {
        const auto views = slice_views(grid);
        for (std::size_t n = 0; n < 3; ++n)
            EXPECT_GT((views[n].away * grid.direction.col(views[n].across)).dot(away[n]), 0.9);
    }
}

TEST(SliceView, knows_no_place_outside_the_volume) {
    const ImageGrid grid{.size = {4, 5, 6}, .spacing = {1, 2, 3}};
    const SliceView axial = slice_views(grid)[0];
    EXPECT_EQ(size_of(axial, grid), Vector2d(4, 10));
    const Vector3d corner = index_at(axial, grid, 0, {0, 0}).value();
    EXPECT_NEAR((corner - Vector3d(-0.5, -0.5, 0)).norm(), 0, 1e-5);
    EXPECT_EQ(std::lround(corner[0]), 0);  // still the first voxel
    EXPECT_FALSE(index_at(axial, grid, 0, {-0.01, 1}));
    EXPECT_FALSE(index_at(axial, grid, 0, {1, 10}));
}

TEST(Layout, a_click_on_a_voxels_picture_gives_that_voxel_in_every_pane_at_every_zoom) {
    for (const ImageGrid& grid : grids())
        for (const double zoom : {1.0, 4.0}) {
            const auto views = slice_views(grid);
            const std::array<std::int32_t, 3> voxel{30, 11, 22};
            const Vector3d index(30, 11, 22);
            const Layout layout = lay_out(grid, views, {1280, 900}, zoom, voxel);
            for (std::size_t n = 0; n < 3; ++n) {
                const PaneFrame& pane = layout.panes[n];
                const Vector2d off = (pane_point(views[n], grid, index) - pane.center) / pane.pixel;
                const Vector2d click = pane.corner + pane.size / 2 + Vector2d(off[0], -off[1]);
                ASSERT_TRUE(pane.holds(click));
                const auto found = index_at(views[n], grid, voxel[static_cast<std::size_t>(views[n].across)],
                                            pane.point_at(click));
                EXPECT_NEAR((found.value() - index).norm(), 0, exact);
            }
        }
}

TEST(Layout, shows_whole_slices_at_one_scale_in_panes_that_do_not_overlap) {
    const ImageGrid grid{.size = {40, 50, 60}, .spacing = {1.5, 0.8, 2.5}};
    const auto views = slice_views(grid);
    const Layout layout = lay_out(grid, views, {1000, 700}, 1, {0, 0, 0});
    for (std::size_t n = 0; n < 3; ++n) {
        const PaneFrame& pane = layout.panes[n];
        EXPECT_EQ(pane.pixel, layout.panes[0].pixel);
        EXPECT_TRUE((size_of(views[n], grid).array() <= pane.pixel * pane.size.array()).all());
        for (std::size_t m = 0; m < 3; ++m)
            EXPECT_EQ(layout.panes[m].holds(pane.corner + pane.size / 2), m == n);
    }
}

}  // namespace
}  // namespace palpate
