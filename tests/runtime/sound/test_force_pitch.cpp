// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gtest/gtest.h>

#include "runtime/sound/force_pitch.hpp"

namespace palpate {
namespace {

using sound::tone_of;

TEST(ForcePitch, a_fourfold_force_sounds_an_octave_higher) {
    for (const double newtons : {0.02, 0.1, 0.5, 1.9})
        EXPECT_NEAR(tone_of(4 * newtons).pitch / tone_of(newtons).pitch, 2, 1e-12);
    EXPECT_DOUBLE_EQ(tone_of(0.02).pitch, 110);
}

TEST(ForcePitch, a_tenth_more_is_heard_as_more_than_a_quarter_tone) {
    EXPECT_GT(tone_of(0.55).pitch / tone_of(0.5).pitch, std::exp2(1.0 / 24));
}

TEST(ForcePitch, what_is_not_felt_is_not_heard_and_nothing_leaves_the_audible) {
    EXPECT_EQ(tone_of(0).loudness, 0);
    EXPECT_EQ(tone_of(0.01).loudness, 0);
    EXPECT_GT(tone_of(0.02).loudness, 0);
    EXPECT_EQ(tone_of(0.03).loudness, 1);
    for (const double newtons : {0.0, 0.001, 1.0, 8.0, 1e6}) {
        EXPECT_GE(tone_of(newtons).pitch, 55);
        EXPECT_LE(tone_of(newtons).pitch, 2200);
        EXPECT_LE(tone_of(newtons).loudness, 1);
    }
}

}  // namespace
}  // namespace palpate
