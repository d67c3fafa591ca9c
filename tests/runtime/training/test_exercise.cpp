// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <gtest/gtest.h>
#include <limits>

#include "runtime/training/exercise.hpp"

namespace palpate {
namespace {

using namespace training;
using Eigen::Vector3d;

constexpr double look = 6, reached = 3, step = 0.1;  // mm
// Of what a right angle may be cut, mm; straight from where a point counts as reached it would be 2.9.
constexpr double cut = 2;
const std::vector<Vector3d> bent{{0, 0, 0}, {20, 0, 0}, {20, 15, 0}, {20, 15, 25}};

// How far from the line a hand comes that goes from `tip` where it looks, past each point that is due.
double farthest_astray(Vector3d tip, const std::vector<Vector3d>& line) {
    double farthest = 0;
    std::size_t due = 0;
    for (int steps = 0; due < line.size(); ++steps) {
        if (steps > 2000) return std::numeric_limits<double>::infinity();
        tip += step * (point_ahead(line, tip, due, look) - tip).normalized();
        farthest = std::max(farthest, nearest_on_line(line, tip, 0, length_of(line)).distance);
        if ((tip - line[due]).norm() <= reached) ++due;
    }
    return farthest;
}

TEST(Exercise, a_hand_that_goes_where_it_looks_follows_the_line) {
    EXPECT_LT(farthest_astray({0, 0, 0}, bent), cut);
}

TEST(Exercise, a_hand_that_begins_beyond_what_is_due_is_led_back_along_the_line) {
    EXPECT_LT(farthest_astray({20, 15, 25}, bent), cut);
}

TEST(Exercise, what_is_due_is_not_looked_beyond) {
    EXPECT_EQ(point_ahead(bent, {18, 1, 0}, 1, look), bent[1]);
    EXPECT_EQ(point_ahead(bent, {21, 4, 0}, 1, look), bent[1]);
    EXPECT_EQ(point_ahead(bent, {18, 1, 0}, 2, look), Vector3d(20, 4, 0));
    EXPECT_EQ(point_ahead(bent, {-9, 1, 3}, 0, look), bent[0]);
}

}  // namespace
}  // namespace palpate
