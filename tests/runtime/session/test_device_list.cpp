// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <set>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/devices/mounted_device.hpp"
#include "runtime/devices/simulation.hpp"
#include "runtime/session/device_list.hpp"

namespace palpate {
namespace {

using namespace devices;
using namespace session;
using Eigen::Vector3d;

constexpr double tolerance = 1e-9;  // mm, of a rigid motion and back
const Vector3d start{10, 20, 30}, up{0, 0, 1};

std::string refusal_of(const std::string& text) {
    try {
        choose_device(text, "--device");
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

HandPath still_path() {
    return HandPath({{0, start}});
}

TEST(DeviceList, says_of_each_device_by_what_it_is_named_and_what_it_is) {
    std::set<std::string> names;
    for (const DeviceKind& kind : device_kinds()) {
        EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
        EXPECT_TRUE(kind.usage.starts_with(kind.name));
        EXPECT_TRUE(kind.usage_of_several.empty() || kind.usage_of_several.starts_with(kind.name + ":"));
        EXPECT_FALSE(kind.sentence.empty()) << kind.name;
        if (kind.usage == kind.name) {
            EXPECT_EQ(choose_device(kind.name).tool_count, 1);
        }
    }
    EXPECT_TRUE(device_kinds().front().name.empty());
}

TEST(DeviceList, names_the_forms_of_the_devices_that_are_asked_for) {
    const auto of_driver = [](const DeviceKind& kind) { return kind.name == "openhaptics"; };
    EXPECT_EQ(device_usages(of_driver, false), "openhaptics[:NAME]");
    EXPECT_EQ(device_usages(of_driver, true), "openhaptics[:NAME] or openhaptics:NAME,NAME");
    const auto stylus = [](const DeviceKind& kind) { return kind.name == "touch" || kind.name == "igtl"; };
    EXPECT_EQ(device_usages(stylus, true), "touch or igtl:HOST:PORT[/NAME]");
    const std::string sentences = device_sentences();
    for (const DeviceKind& kind : device_kinds())
        if (!kind.name.empty()) {
            EXPECT_NE(sentences.find(kind.sentence), std::string::npos) << kind.name;
        }
}

TEST(DeviceList, reads_name_and_address) {
    EXPECT_EQ(choose_device("").kind.name, "");
    EXPECT_TRUE(choose_device("premium").kind.simulated);
    const DeviceChoice two = choose_device("openhaptics:Left,Right");
    EXPECT_EQ(two.kind.name, "openhaptics");
    EXPECT_EQ(two.address, "Left,Right");
    EXPECT_EQ(two.tool_count, 2);
    EXPECT_EQ(choose_device("openhaptics").tool_count, 1);
    EXPECT_EQ(choose_device("igtl:127.0.0.1:18944/Stylus").address, "127.0.0.1:18944/Stylus");
}

TEST(DeviceList, refuses_what_it_does_not_know_with_what_it_knows) {
    const std::string all = "(expected " + device_usages([](const DeviceKind&) { return true; }, true) + ")";
    EXPECT_TRUE(all.starts_with("(expected touch, desktop, premium"));
    for (const std::string text : {"falcon", "touch:1", "touch:", "openhapticsX", ":", ":x"})
        EXPECT_EQ(refusal_of(text), "--device: " + text + " " + all);
    for (const std::string text : {"openhaptics:", "openhaptics:A,", "openhaptics:,A"})
        EXPECT_EQ(refusal_of(text),
                  "--device: " + text + " (expected openhaptics[:NAME] or openhaptics:NAME,NAME)");
    EXPECT_NE(refusal_of("igtl:127.0.0.1").find("HOST:PORT"), std::string::npos);
    EXPECT_NE(refusal_of("igtl:").find("HOST:PORT"), std::string::npos);
    EXPECT_NE(refusal_of("igtl").find("HOST:PORT"), std::string::npos);
}

TEST(DeviceList, every_simulated_device_starts_where_its_script_does_and_says_so_in_the_patients_frame) {
    for (const DeviceKind& kind : device_kinds()) {
        if (!kind.simulated) continue;
        const HeldTool tool = scripted_tool(still_path(), up, {0, 0, 1});
        const OpenDevices open = choose_device(kind.name).open(
            {.tools = {tool, tool}, .limits = {.max_force = 5, .max_stiffness = 0.5}});
        ASSERT_EQ(open.devices.size(), 2);
        EXPECT_FALSE(open.guide);
        EXPECT_EQ(open.servo, nullptr);
        for (const auto& device : open.devices) {
            const realtime::DeviceState state = device->read(0);
            // Encoders round each coordinate down in the device's frame.
            EXPECT_NEAR((vector_of(state.position) - start).norm(), 0, 0.1) << kind.name;
            EXPECT_NEAR((vector_of(state.shaft) - up).norm(), 0, tolerance);
            EXPECT_GT(device->limits().max_force, 0);
        }
    }
}

TEST(DeviceList, every_simulated_device_without_a_script_goes_where_it_is_guided) {
    for (const DeviceKind& kind : device_kinds()) {
        if (!kind.simulated) continue;
        const Eigen::Quaterniond first(Eigen::AngleAxisd(0.4, Vector3d::UnitX())),
            turned(Eigen::AngleAxisd(0.7, Vector3d::UnitY()));
        const OpenDevices open = kind.open(
            "", {.tools = {{.place = DevicePlace{start, upright(up)}, .orientation = first}}, .limits = {}});
        ASSERT_TRUE(open.guide) << kind.name;
        EXPECT_LT(quaternion_of(open.devices[0]->read(0).orientation).angularDistance(first), 1e-3);
        const Vector3d there = start + Vector3d(3, -2, 4);
        open.guide(there, turned);
        realtime::DeviceState state;
        for (int tick = 0; tick < 3000; ++tick) state = open.devices[0]->read(1e-3 * tick);
        EXPECT_NEAR((vector_of(state.position) - there).norm(), 0, 1.2) << kind.name;  // backdrive friction
        EXPECT_GT((vector_of(state.position) - start).norm(), 4) << kind.name;
        EXPECT_LT(quaternion_of(state.orientation).angularDistance(turned), 1e-3) << kind.name;
    }
}

}  // namespace
}  // namespace palpate
