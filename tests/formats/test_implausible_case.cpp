// SPDX-License-Identifier: Apache-2.0
// What a case must not be, though each of its parts is well formed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/asset/asset.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace asset;
using sample::refusal;
using sample::Scratch;
using ::testing::HasSubstr;

TEST(ImplausibleCase, with_a_provenance_nested_too_deeply_is_refused) {
    const Scratch scratch;
    Case patient_case = sample::sample_case();
    const auto nested = [](int levels) {
        const auto times = static_cast<std::size_t>(levels);
        return R"({"note": "a \" and [[[", "list": )" + std::string(times, '[') + std::string(times, ']') +
               "}";
    };
    patient_case.provenance = nested(63);
    EXPECT_EQ(refusal([&] { write_asset(scratch / "a.vtkhdf", patient_case); }), "");
    patient_case.provenance = nested(64);
    EXPECT_THAT(refusal([&] { write_asset(scratch / "b.vtkhdf", patient_case); }),
                HasSubstr("/palpate/provenance: is nested too deeply (expected 64 levels at most)"));
}

TEST(ImplausibleCase, whose_box_leaves_a_triangle_outside_is_refused) {
    const Scratch scratch;
    Case loose = sample::sample_case(1);
    loose.rigid_bodies[0].obb_tree.nodes[3].half_extents *= 0.9F;
    EXPECT_THAT(refusal([&] { write_asset(scratch / "a.vtkhdf", loose); }),
                HasSubstr("box 3 leaves a triangle"));
}

TEST(ImplausibleCase, with_settings_that_no_device_has_is_refused) {
    const Scratch scratch;
    for (double HapticSettings::*setting :
         {&HapticSettings::tool_radius, &HapticSettings::coupling_stiffness, &HapticSettings::max_force,
          &HapticSettings::max_force_rate, &HapticSettings::friction_at_rest, &HapticSettings::shaft_length,
          &HapticSettings::grip}) {
        Case strong = sample::sample_case(1);
        strong.haptics.*setting = 1e9;
        EXPECT_THAT(refusal([&] { write_asset(scratch / "a.vtkhdf", strong); }), HasSubstr("is 1000000000"));
    }
}

}  // namespace
}  // namespace palpate
