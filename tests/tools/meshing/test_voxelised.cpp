// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tools/meshing/labels/voxelised.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

// An octahedron |x| + |y| + |z| < radius about a centre, seen from outside.
TriangleMesh octahedron(const Vector3d& centre, double radius) {
    TriangleMesh surface;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {radius, -radius})
            surface.vertices.emplace_back(centre + side * Vector3d::Unit(axis));
    surface.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                         {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    return surface;
}

// How many voxels are not as the distance sum from the centre says; none counts within 1e-6 of the surface.
std::size_t wrong_voxels(const LabelMap& map, const Vector3d& centre, double inner, double outer) {
    std::size_t wrong = 0, offset = 0;
    for (int k = 0; k < map.grid.size[2]; ++k)
        for (int j = 0; j < map.grid.size[1]; ++j)
            for (int i = 0; i < map.grid.size[0]; ++i, ++offset) {
                const double sum = (map.grid.point_of(Vector3d(i, j, k)) - centre).lpNorm<1>();
                const bool doubtful = std::abs(sum - inner) < 1e-6 || std::abs(sum - outer) < 1e-6;
                if (!doubtful && (sum > inner && sum < outer) != (map.labels[offset] == 1)) ++wrong;
            }
    return wrong;
}

TEST(Voxelised, holds_the_voxels_whose_centre_is_inside) {
    const Vector3d centre(10.3, -20.1, 5.7);
    const LabelMap map = meshing::voxelised(octahedron(centre, 12), "prostate", 0.5);
    ASSERT_EQ(map.names.size(), 1U);
    EXPECT_EQ(map.names[0].name, "prostate");
    EXPECT_GT(std::ranges::count(map.labels, 1), 10'000);
    EXPECT_EQ(wrong_voxels(map, centre, -1, 12), 0U);
}

TEST(Voxelised, leaves_cavities_out) {
    const Vector3d centre(0.1, 0.2, 0.3);
    TriangleMesh hollow = octahedron(centre, 12);
    const TriangleMesh cavity = octahedron(centre, 6);
    for (const Triangle& t : cavity.triangles) hollow.triangles.push_back({t[0] + 6, t[2] + 6, t[1] + 6});
    hollow.vertices.insert(hollow.vertices.end(), cavity.vertices.begin(), cavity.vertices.end());
    EXPECT_EQ(wrong_voxels(meshing::voxelised(hollow, "bladder", 0.47), centre, 6, 12), 0U);
}

TEST(Voxelised, of_less_than_a_voxel_is_refused) {
    EXPECT_THROW(meshing::voxelised(octahedron({0.4, 0.4, 0.4}, 0.1), "gland", 5), InvalidInput);
}

}  // namespace
}  // namespace palpate
