// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/model/regions.hpp"

namespace palpate {
namespace {

// Region 3: one large tetrahedron; region 8: two small ones, on nodes that it does not have.
TetMesh finely_meshed_lump() {
    TetMesh mesh;
    mesh.rest_positions = {{0, 0, 0},  {9, 0, 0},  {0, 9, 0},  {0, 0, 9},  {20, 0, 0},
                           {21, 0, 0}, {20, 1, 0}, {20, 0, 1}, {20, 0, -1}};
    mesh.tetrahedra = {{0, 1, 2, 3}, {4, 5, 6, 7}, {4, 6, 5, 8}};
    mesh.regions = {3, 8, 8};
    mesh.region_names = {
        {.value = 3, .name = "organ"}, {.value = 5, .name = "gone"}, {.value = 8, .name = "lump"}};
    return mesh;
}

TEST(Regions, the_main_one_has_most_volume_whatever_its_tetrahedra) {
    EXPECT_EQ(main_region(finely_meshed_lump()), 3);
}

TEST(Regions, all_others_that_occur_are_enclosed) {
    const auto enclosed = enclosed_regions(finely_meshed_lump());
    ASSERT_EQ(enclosed.size(), 1U);
    EXPECT_EQ(enclosed.front().name, "lump");
}

TEST(Regions, nodes_of_one_are_told_once_in_order) {
    EXPECT_THAT(nodes_of_region(finely_meshed_lump(), 8), ::testing::ElementsAre(4, 5, 6, 7, 8));
    EXPECT_TRUE(nodes_of_region(finely_meshed_lump(), 5).empty());
}

}  // namespace
}  // namespace palpate
