// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>

#include "formats/model/errors.hpp"
#include "runtime/session/hand_script.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace session;

const devices::TouchPoint place{
    .point = {1, 2, 3}, .normal = {0, 0, 1}, .tangent = {1, 0, 0}, .clearance = 5};
constexpr devices::ScriptSettings settings{.tool_radius = 2, .depth = 1.5, .seconds = 2};

class MadeToMeasure : public ::testing::TestWithParam<const char*> {};

TEST_P(MadeToMeasure, goes_in_at_its_place_and_no_deeper_than_it_was_told) {
    ASSERT_TRUE(is_made_to_measure(GetParam()));
    const devices::HandPath path = made_to_measure_path(GetParam(), place, settings, 7);
    double lowest = 1e9;
    for (int tick = 0; tick < 2000; ++tick) lowest = std::min(lowest, path.at(1e-3 * tick).z());
    const double surface = place.point.z() + settings.tool_radius;
    EXPECT_LT(lowest, surface);
    EXPECT_GE(lowest, surface - settings.depth - settings.tremor - 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Scripts, MadeToMeasure,
                         ::testing::Values("press", "slide", "tremble", "let-go", "random"));

TEST(HandScript, that_is_a_file_is_read_and_one_that_is_neither_is_named) {
    const sample::Scratch scratch;
    const std::string file = (scratch / "hand.txt").string();
    std::ofstream(file) << "0 0 0 9\n0.001 0 0 8\n0.002 0 0 7\n";
    EXPECT_FALSE(is_made_to_measure(file));
    EXPECT_EQ(recorded_path(file).at(1e-3).z(), 8);
    EXPECT_NEAR(recorded_axis_path(file, 4, place, settings).at(0).z(),
                place.point.z() + settings.tool_radius - settings.depth, 1e-9);
    EXPECT_THAT(sample::refusal([] { recorded_path("pres"); }),
                ::testing::AllOf(::testing::HasSubstr("pres"), ::testing::HasSubstr("tremble")));
    EXPECT_THROW(recorded_axis_path("pres", 1, place, settings), InvalidInput);
    EXPECT_THROW(recorded_axis_path("press", 1, place, settings), UsageError);
}

}  // namespace
}  // namespace palpate
