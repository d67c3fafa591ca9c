// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "runtime/haptics/contact/triangle_neighbours.hpp"

namespace palpate {
namespace {

using haptics::triangle_neighbours;
using Neighbours = std::array<std::int32_t, 3>;

TEST(TriangleNeighbours, lie_across_the_edge_from_each_corner_to_the_next) {
    const auto found = triangle_neighbours({{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}});
    EXPECT_EQ(found, (std::vector<Neighbours>{{3, 1, 2}, {2, 0, 3}, {3, 0, 1}, {1, 0, 2}}));
}

TEST(TriangleNeighbours, are_the_triangle_itself_across_an_open_edge) {
    EXPECT_EQ(triangle_neighbours({{4, 7, 9}}), (std::vector<Neighbours>{{0, 0, 0}}));
    EXPECT_EQ(triangle_neighbours({{0, 1, 2}, {1, 0, 3}}), (std::vector<Neighbours>{{1, 0, 0}, {0, 1, 1}}));
    EXPECT_TRUE(triangle_neighbours({}).empty());
}

TEST(TriangleNeighbours, are_the_first_of_several_across_one_edge) {
    EXPECT_EQ(triangle_neighbours({{0, 1, 2}, {1, 0, 3}, {1, 0, 4}})[0][0], 1);
}

}  // namespace
}  // namespace palpate
