// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/condensation/condense.hpp"
#include "tools/fem/condensation/sway.hpp"

namespace palpate {
namespace {

using namespace fem;

// Upright, 20 mm high and held at its foot, of 6.3 kPa without Poisson's ratio.
DeformableBody bar(double width) {
    return condensed_body(
        test::held_block({2, 2, 10}, {width, width, 20}, {.youngs_modulus = 6.3e-3, .poissons_ratio = 0}),
        test::no_progress);
}

TEST(Sway, of_a_bar_is_that_of_a_beam_and_farthest_at_its_end) {
    const DeformableBody slender = bar(4);
    const Sway sway = sway_of(slender);
    EXPECT_EQ(sway.place.z(), 20);
    // Bernoulli's beam under a force spread evenly, F L^3 / (8 E I), besides shear; stiffer by its coarse
    // elements.
    const double beam = 0.1 * 20 * 20 * 20 / (8 * 6.3e-3 * (4.0 * 4 * 4 * 4 / 12));
    EXPECT_GT(sway.distance, 0.3 * beam);
    EXPECT_LT(sway.distance, 1.5 * beam);
    EXPECT_TRUE(hangs(slender, sway));
    EXPECT_NE(hanging_text(sway).find(", 20), of which"), std::string::npos) << hanging_text(sway);
}

TEST(Sway, of_what_is_held_well_is_small) {
    const DeformableBody stout = bar(20);
    EXPECT_FALSE(hangs(stout, sway_of(stout)));
}

}  // namespace
}  // namespace palpate
