// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <gtest/gtest.h>
#include <string>
#include <type_traits>

#include "tests/runtime/devices/openhaptics/hd_library/hd_functions.hpp"
#include "tests/runtime/devices/openhaptics/hd_library/hd_script.hpp"

namespace palpate::hd {

using Vector = std::array<double, 3>;

inline std::string conformance_library_path() {
    return PALPATE_HD_CONFORMANCE;
}

/// The library, fresh for each test.
class HdConformance : public testing::Test {
  protected:
    Functions hd{conformance_library_path()};

    void configure(const std::string& json) {
        const char* message = hd.configure(json.c_str());
        ASSERT_EQ(message, nullptr) << message;
    }
    /// A Touch at rest and open, of which `more` tells.
    Handle open(const std::string& more = "", const std::string& clock = "virtual") {
        configure(R"({"clock":")" + clock + R"(","devices":[{"name":"A")" + (more.empty() ? "" : ",") + more +
                  "}]}");
        return hd.hdInitDevice(nullptr);
    }
    unsigned error() { return hd.hdGetError().code; }
    /// Runs `action` once in the servo, and counts ticks.
    template <class Action>
    void in_servo(Action&& action) {
        hd.hdScheduleSynchronous(
            [](void* data) -> unsigned {
                (*static_cast<std::remove_reference_t<Action>*>(data))();
                return callback_done;
            },
            &action, 32767);
    }
    /// One whole frame with this force.
    void frame(Handle device, const Vector& force) {
        hd.hdBeginFrame(device);
        hd.hdSetDoublev(current_force, force.data());
        hd.hdEndFrame(device);
    }
    /// That many ticks with this force.
    void push(Handle device, const Vector& force, int ticks) {
        for (int tick = 0; tick < ticks; ++tick) in_servo([&] { frame(device, force); });
    }
    Vector rendered(Handle device) {
        const Hardware at = hd.hardware(device);
        return {at.rendered[0], at.rendered[1], at.rendered[2]};
    }
    ~HdConformance() override { hd.configure("{}"); }
};

}  // namespace palpate::hd
