// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "formats/model/disjoint_sets.hpp"

namespace palpate {
namespace {

TEST(DisjointSets, are_numbered_by_their_smallest_members) {
    DisjointSets sets(7);
    sets.join(6, 2);
    sets.join(5, 6);
    sets.join(4, 0);
    EXPECT_EQ(sets.root(5), 2U);
    EXPECT_EQ(sets.root(3), 3U);
    EXPECT_THAT(sets.numbered(), ::testing::ElementsAre(0, 1, 2, 3, 0, 2, 2));
}

// Brute force: joining two sets gives every member of both the smaller of their roots.
TEST(DisjointSets, are_those_of_relabelling_every_member) {
    constexpr std::size_t count = 200;
    std::mt19937 random(5);
    DisjointSets sets(count);
    std::vector<std::size_t> label(count);
    for (std::size_t i = 0; i < count; ++i) label[i] = i;
    for (int join = 0; join < 150; ++join) {
        const std::size_t a = random() % count, b = random() % count;
        sets.join(a, b);
        const std::size_t from = std::max(label[a], label[b]), to = std::min(label[a], label[b]);
        for (std::size_t& each : label)
            if (each == from) each = to;
    }
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(sets.root(i), label[i]) << i;
}

}  // namespace
}  // namespace palpate
