// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <memory>
#include <thread>

#include "formats/model/errors.hpp"
#include "runtime/devices/openhaptics/hd_servo.hpp"
#include "tests/runtime/devices/openhaptics/fake_hd_driver.hpp"

namespace palpate {
namespace {

using namespace devices;
using namespace realtime;
using namespace hdapi;

class HdServoTest : public testing::Test {
  protected:
    HdServoTest() {
        reset_fake_hd_driver();
        device_ = std::make_unique<HdDevice>(fake_hd_api(), errors_, "", true);
    }

    HdErrorSorter errors_{fake_hd_api()};
    std::unique_ptr<HdDevice> device_;
};

TEST_F(HdServoTest, time_is_the_number_of_ticks_and_starts_anew) {
    HdServo servo(fake_hd_api(), {device_.get()}, {});
    for (int round = 0; round < 2; ++round) {
        std::int64_t ticks = 0, wrong = 0;
        std::atomic<bool> enough{false};
        servo.start([&](const ServoTick& tick) {
            wrong += tick.time != 1e-9 * static_cast<double>(++ticks * Servo::period_ns);
            if (ticks == 100) enough = true;
        });
        while (!enough) std::this_thread::yield();
        servo.stop();
        EXPECT_GE(ticks, 100);
        EXPECT_EQ(wrong, 0);
    }
}

TEST_F(HdServoTest, ends_with_no_force_and_a_scheduler_that_stands) {
    HdServo servo(fake_hd_api(), {device_.get()}, {});
    servo.start([&](const ServoTick& tick) {
        device_->read(tick.time);
        device_->write({{1, 2, 3}});
    });
    EXPECT_TRUE(fake_hd_driver().runs);
    servo.stop();
    EXPECT_EQ(fake_hd_driver().devices[0].force, (std::array<double, 3>{0, 0, 0}));
    EXPECT_GE(fake_hd_driver().devices[0].frames, 2);
    EXPECT_FALSE(fake_hd_driver().runs);
}

TEST_F(HdServoTest, one_tick_is_one_tick) {
    HdServo servo(fake_hd_api(), {device_.get()}, {});
    int ticks = 0;
    servo.tick_once([&](const ServoTick&) { ++ticks; });
    EXPECT_EQ(ticks, 1);
    EXPECT_TRUE(fake_hd_driver().runs);
}

TEST_F(HdServoTest, periods_without_a_tick_are_overruns_and_latency) {
    fake_hd_driver().gap_after_tick = 1;
    fake_hd_driver().gap_ms = 20;
    HdServo servo(fake_hd_api(), {device_.get()}, {});
    std::atomic<std::int64_t> overruns{0}, latency_ns{0};
    std::atomic<int> ticks{0};
    servo.start([&](const ServoTick& tick) {
        if (++ticks != 2) return;
        overruns = tick.overruns;
        latency_ns = tick.wake_latency_ns;
    });
    while (ticks < 2) std::this_thread::yield();
    servo.stop();
    // The gap is 20 ms or more: a thread sleeps for no less.
    EXPECT_GE(overruns, 19);
    EXPECT_GE(latency_ns, 19 * Servo::period_ns);
}

TEST_F(HdServoTest, a_rate_that_the_driver_does_not_let_itself_be_told_is_tolerated) {
    for (const unsigned code : {invalid_value, timer_error, invalid_operation}) {
        fake_hd_driver().rate_error = code;
        HdServo servo(fake_hd_api(), {device_.get()}, {});
        servo.start([](const ServoTick&) {});
        EXPECT_TRUE(servo.setup().front().ok);
    }
    fake_hd_driver().rate_error = comm_error;
    HdServo servo(fake_hd_api(), {device_.get()}, {});
    EXPECT_THROW(servo.start([](const ServoTick&) {}), SystemFailure);
}

TEST_F(HdServoTest, a_scheduler_that_does_not_start_or_tick_is_said_to) {
    HdServo servo(fake_hd_api(), {device_.get()}, {});
    fake_hd_driver().start_error = timer_error;
    EXPECT_THROW(servo.start([](const ServoTick&) {}), SystemFailure);
    EXPECT_FALSE(fake_hd_driver().runs);
    fake_hd_driver().start_error = success;
    fake_hd_driver().ticks = false;
    EXPECT_THROW(servo.start([](const ServoTick&) {}), SystemFailure);
    EXPECT_FALSE(fake_hd_driver().runs);
}

TEST_F(HdServoTest, tells_the_rate_then_the_notes) {
    const HdServo servo(fake_hd_api(), {device_.get()}, {{false, "a note"}});
    const auto setup = servo.setup();
    ASSERT_EQ(setup.size(), 2u);
    EXPECT_NE(setup[0].message.find("1000 times a second"), std::string::npos);
    EXPECT_EQ(setup[1].message, "a note");
}

}  // namespace
}  // namespace palpate
