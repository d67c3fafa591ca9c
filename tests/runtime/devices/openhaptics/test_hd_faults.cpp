// SPDX-License-Identifier: Apache-2.0
// The conformance library's troubles, seen as an application sees them.
#include <array>
#include <atomic>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/runtime/devices/openhaptics/hd_conformance.hpp"

namespace palpate::hd {
namespace {

// What one tick of trouble looks like: errors in the order they came, position, temperature, force.
struct Seen {
    std::vector<unsigned> errors;
    Vector position{};
    double temperature = 0;
    bool force = false;
    bool operator==(const Seen&) const = default;
};

TEST_F(HdConformance, each_fault_shows_in_its_way_and_vanishes) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Vector still{9, 0, 0}, moved{10, 0, 0};
    const std::array<std::pair<const char*, Seen>, 9> faults{{
        {"warm_motors", {{warm_motors}, moved, 1, false}},
        {"comm_error", {{comm_error}, moved, 0.2, false}},
        {"disconnect", {{comm_error}, still, 0.2, false}},
        {"not_a_number", {{}, {nan, nan, nan}, 0.2, true}},
        {"frozen_pose", {{}, {0, -110, -35}, 0.2, true}},
        {"max_force", {{exceeded_max_force}, moved, 0.2, false}},
        {"velocity", {{exceeded_velocity}, moved, 0.2, false}},
        {"impulse", {{exceeded_impulse}, moved, 0.2, false}},
        {"timer_error", {{timer_error}, moved, 0.2, true}},
    }};
    for (const auto& [name, expected] : faults) {
        const Handle device = open(R"("hand":"rigid","path":[[0,0,0,0],[1,1000,0,0]],"faults":[{"fault":")" +
                                   std::string(name) + R"(","from":0.01,"until":0.011}])");
        hd.hdEnable(force_output);
        hd.hdStartScheduler();
        for (int tick = 1; tick <= 12; ++tick)
            in_servo([&] {
                Seen seen;
                Vector temperatures{};
                const Vector force{1, 0, 0};
                hd.hdBeginFrame(device);
                hd.hdGetDoublev(current_position, seen.position.data());
                hd.hdGetDoublev(motor_temperature, temperatures.data());
                hd.hdSetDoublev(current_force, force.data());
                hd.hdEndFrame(device);
                seen.temperature = temperatures[0];
                seen.force = rendered(device)[0] > 0;
                for (unsigned code = error(); code != success; code = error()) seen.errors.push_back(code);
                const Seen well{{}, {1.0 * tick, 0, 0}, 0.2, true}, &right = tick == 10 ? expected : well;
                EXPECT_EQ(seen.errors, right.errors) << name << ", tick " << tick;
                EXPECT_EQ(seen.temperature, right.temperature) << name << ", tick " << tick;
                EXPECT_EQ(seen.force, right.force) << name << ", tick " << tick;
                for (std::size_t k = 0; k < 3; ++k)
                    EXPECT_TRUE(std::isnan(right.position[k])
                                    ? std::isnan(seen.position[k])
                                    : std::abs(seen.position[k] - right.position[k]) < 1e-9)
                        << name << ", tick " << tick << ": " << seen.position[k];
            });
    }
}

TEST_F(HdConformance, a_failed_frame_is_not_open) {
    const Handle device = open(R"("faults":[{"fault":"frame_failure","from":0,"until":0.5}])");
    hd.hdBeginFrame(device);
    EXPECT_EQ(error(), frame_error);
    Vector p{};
    hd.hdGetDoublev(current_position, p.data());
    EXPECT_EQ(error(), invalid_operation);
}

TEST_F(HdConformance, lost_calibration_comes_back) {
    open(R"("styles":["inkwell"],"faults":[{"fault":"calibration_lost","from":0.001,"until":0.003}])");
    hd.hdStartScheduler();
    std::vector<unsigned> states;
    for (int tick = 1; tick <= 4; ++tick) in_servo([&] { states.push_back(hd.hdCheckCalibration()); });
    EXPECT_EQ(states, (std::vector<unsigned>{calibration_needs_manual_input, calibration_needs_manual_input,
                                             calibration_ok, calibration_ok}));
}

TEST_F(HdConformance, a_stalled_scheduler_skips_the_time) {
    for (const char* clock : {"virtual", "real"}) {
        const Handle device =
            open(R"("faults":[{"fault":"scheduler_stall","from":0.005,"until":0.1}])", clock);
        hd.hdStartScheduler();
        int ticks_inside = 0;
        double time = 0;
        while (time < 0.1)
            in_servo([&] {
                time = hd.hardware(device).time;
                if (time > 0.005 && time < 0.1) ++ticks_inside;
            });
        // On the real clock a late tick may be the first inside, and then waits for the end.
        EXPECT_LE(ticks_inside, 1) << clock;
    }
}

TEST_F(HdConformance, pauses_after_so_many_ticks) {
    configure(R"({"clock":"virtual","pause_after_ticks":7})");
    const Handle device = hd.hdInitDevice(nullptr);
    std::atomic<int> calls{0};
    hd.hdScheduleAsynchronous(
        [](void* data) -> unsigned {
            ++*static_cast<std::atomic<int>*>(data);
            return callback_continue;
        },
        &calls, 1);
    hd.hdStartScheduler();
    while (hd.hardware(device).time < 0.0069) {
    }
    hd.hdStopScheduler();
    EXPECT_EQ(calls, 7);
}

}  // namespace
}  // namespace palpate::hd
