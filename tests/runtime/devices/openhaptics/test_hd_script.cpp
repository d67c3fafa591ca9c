// SPDX-License-Identifier: Apache-2.0
// What the conformance library is told, and the angles behind a Touch's positions.
#include <array>
#include <gtest/gtest.h>
#include <string>

#include "formats/model/errors.hpp"
#include "tests/runtime/devices/openhaptics/hd_conformance.hpp"
#include "tests/runtime/devices/openhaptics/hd_library/touch_angles.hpp"

namespace palpate::hd {
namespace {

TEST(HdScript, a_misspelt_script_is_refused_by_name) {
    const auto refusal = [](const char* json) -> std::string {
        try {
            parse_script(json);
            return "";
        } catch (const Error& error) {
            return error.what();
        }
    };
    EXPECT_NE(refusal(R"({"clok":"real"})").find("clok"), std::string::npos);
    EXPECT_NE(refusal(R"({"clock":"slow"})").find("real, virtual"), std::string::npos);
    EXPECT_NE(refusal(R"({"devices":[{"model":"falcon"}]})").find("falcon"), std::string::npos);
    EXPECT_NE(refusal(R"({"devices":[{"faults":[{"fault":"smoke"}]}]})").find("smoke"), std::string::npos);
    EXPECT_NE(refusal("{").find("JSON"), std::string::npos);
    EXPECT_NE(refusal(R"({"rate_hz":300})").find("500 or 1000"), std::string::npos);
    EXPECT_EQ(refusal("{}"), "");
}

// The inkwell's pose that SOFA recorded (GeomagicDriver), and its angles.
TEST(TouchAngles, give_the_recorded_pose_of_the_inkwell) {
    const Vector angles = touch_angles({0, -65.5107, -88.1142});
    EXPECT_NEAR(angles[0], 0, 1e-5);
    EXPECT_NEAR(angles[1], 0.26889, 1e-5);
    EXPECT_NEAR(angles[2], -0.370813, 1e-5);
}

TEST(TouchAngles, invert_the_way_from_angles_to_the_tip) {
    for (double x = -80; x <= 80; x += 20)
        for (double y = -60; y <= 60; y += 20)
            for (double z = -35; z <= 35; z += 10) {
                const Vector p = touch_position(touch_angles({x, y, z}));
                EXPECT_NEAR(p[0], x, 1e-11);
                EXPECT_NEAR(p[1], y, 1e-11);
                EXPECT_NEAR(p[2], z, 1e-11);
            }
}

TEST(TouchAngles, all_zero_are_where_a_device_without_encoder_data_seems_to_be) {
    const Vector p = touch_position({0, 0, 0});
    EXPECT_NEAR(p[0], 0, 1e-12);
    EXPECT_NEAR(p[1], -110, 1e-12);
    EXPECT_NEAR(p[2], -35, 1e-12);
}

}  // namespace
}  // namespace palpate::hd
