// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "formats/model/regions.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

// Region 7: two tetrahedra on both sides of the triangle 0 1 2; region 2: three that lie about them.
TetMesh two_regions() {
    TetMesh mesh;
    mesh.rest_positions = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {1, 1, 3}, {1, 1, -3}, {9, 9, 0}, {1, 1, 9}};
    mesh.tetrahedra = {{0, 1, 2, 3}, {0, 2, 1, 4}, {1, 5, 2, 3}, {1, 2, 5, 4}, {1, 5, 3, 6}};
    mesh.regions = {7, 7, 2, 2, 2};
    mesh.region_names = {
        {.value = 2, .name = "organ"}, {.value = 5, .name = "gone"}, {.value = 7, .name = "lump"}};
    return mesh;
}

TEST(RegionSurface, all_regions_but_the_largest_are_enclosed) {
    const auto enclosed = enclosed_regions(two_regions());
    ASSERT_EQ(enclosed.size(), 1U);
    EXPECT_EQ(enclosed.front().name, "lump");
}

TEST(RegionName, is_the_mesh_s_or_its_value) {
    EXPECT_EQ(region_name(two_regions(), 7), "lump");
    EXPECT_EQ(region_name(two_regions(), 3), "label 3");
}

TEST(RegionSurface, has_only_faces_towards_other_regions) {
    const TriangleMesh surface = surface_of_region(two_regions(), 7).surface;
    EXPECT_EQ(surface.triangles.size(), 6U);
    EXPECT_EQ(surface.vertices.size(), 5U);
}

TEST(RegionSurface, is_oriented_outwards) {
    const TriangleMesh surface = surface_of_region(two_regions(), 7).surface;
    double volume = 0;  // by the divergence theorem
    for (const Triangle& t : surface.triangles)
        volume += surface.vertices[t[0]].dot(surface.vertices[t[1]].cross(surface.vertices[t[2]])) / 6;
    EXPECT_NEAR(volume, 9, 1e-12);
}

TEST(RegionSurface, of_a_region_that_is_not_there_is_empty) {
    EXPECT_TRUE(surface_of_region(two_regions(), 5).surface.triangles.empty());
}

}  // namespace
}  // namespace palpate
