// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <thread>

#include "formats/model/errors.hpp"
#include "runtime/devices/guided_device.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using namespace haptics;
using namespace realtime;

// Remembers the last force it was given.
class RecordingDevice final : public Device {
  public:
    std::string name() const override { return "recording"; }
    DeviceLimits limits() const override { return {}; }
    DeviceState read(double time) noexcept override {
        DeviceState state;
        state.position = {40, 10, time < 0.005 ? 30.0 : 24.5};
        return state;
    }
    void write(const Wrench& wrench) noexcept override { force_ = wrench.force; }
    std::array<double, 3> force_{9, 9, 9};
};

TEST(ServoLoop, every_tick_reaches_the_logger_and_the_latest_the_screen) {
    HapticModel model(sample::sample_case());
    devices::GuidedDevice device({{40, 10, 32}}, {}, 200);
    ServoLoop loop(model, device, 1024);
    loop.start();
    device.set_target({{40, 10, 25}});
    std::int64_t logged = 0, last_seen = -1;
    double strongest = 0;
    TickResult record{};
    for (int frame = 0; frame < 20; ++frame) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        while (loop.ring().pop(record)) {
            EXPECT_EQ(record.tick, logged++);
            strongest = std::max(strongest, record.force[2]);
        }
        const TickResult& latest = loop.latest().read();
        EXPECT_GE(latest.tick, last_seen);
        last_seen = latest.tick;
    }
    loop.stop();
    while (loop.ring().pop(record)) EXPECT_EQ(record.tick, logged++);
    const ServoStatistics statistics = loop.statistics();
    EXPECT_EQ(statistics.ticks, logged + static_cast<std::int64_t>(statistics.lost_records));
    EXPECT_EQ(statistics.tick_ns.count(), static_cast<std::uint64_t>(statistics.ticks));
    EXPECT_EQ(statistics.setup.size(), 2U);
    EXPECT_GT(strongest, 0);
    EXPECT_EQ(record.faults, servo_stopping);
    EXPECT_EQ(record.force, (std::array<double, 3>{0, 0, 0}));
}

TEST(ServoLoop, published_schemes_detect_beside_the_ticks) {
    HapticModel model(sample::sample_case(), "twice");
    RecordingDevice device;
    ServoLoop loop(model, device, 1024);
    loop.start();
    // 1 mm below the skull's top: felt once the collision loop has looked, a thirtieth of a second later.
    double strongest = 0;
    for (int frame = 0; frame < 40 && strongest == 0; ++frame) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        strongest = loop.latest().read().force[2];
    }
    loop.stop();
    EXPECT_GT(strongest, 0);
}

TEST(ServoLoop, changes_its_model_with_the_force_at_zero_and_counts_on) {
    HapticModel first(sample::sample_case()), second(sample::sample_case(), "twice");
    devices::GuidedDevice device({{40, 10, 32}}, {}, 200);
    ServoLoop loop(first, device, 8192);
    const auto go = [&](double z) {
        device.set_target({{40, 10, z}});
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
    };
    loop.start();
    go(24.5);
    EXPECT_GT(loop.latest().read().force[2], 0);
    ASSERT_TRUE(loop.change_model(second));
    EXPECT_LT(loop.latest().read().force[2], 0.01);
    for (int i = 0; i < 3; ++i) go(24.5);
    EXPECT_GT(loop.latest().read().force[2], 0);
    loop.stop();

    std::int64_t logged = 0;
    double force = 0, largest_step = 0;
    bool changing = false;
    TickResult record{};
    while (loop.ring().pop(record)) {
        EXPECT_EQ(record.tick, logged++);
        changing = changing || (record.faults & servo_stopping);
        if (changing) largest_step = std::max(largest_step, std::abs(force - record.force[2]));
        force = record.force[2];
    }
    EXPECT_TRUE(changing);
    EXPECT_LT(largest_step, 0.1 * first.settings().max_force) << "the force ramps, down and up again";
}

TEST(ServoLoop, stays_with_its_model_where_the_servo_does_not_tick) {
    HapticModel first(sample::sample_case()), second(sample::sample_case(), "twice"),
        of_two_tools(sample::sample_case(), usual_contact_method, 2);
    RecordingDevice device;
    ServoLoop loop(first, device, 64);
    EXPECT_FALSE(loop.change_model(second));
    EXPECT_THROW(loop.change_model(of_two_tools), InvalidInput);
}

TEST(TickOutlet, hands_over_a_tick_with_the_contacts_that_count_and_copies_no_others) {
    constexpr float seen = 1, unseen = 2;
    TickOutlet outlet(1, 1);
    TickResult result{};
    for (Contact& contact : result.contacts) contact.force = unseen;
    for (int tick = 0; tick < 4; ++tick) {  // so that every slot is used again
        result.tick = tick;
        result.contact_count = 2;
        result.contacts[0].force = result.contacts[1].force = seen;
        outlet.publish({&result, 1});
        TickResult popped{};
        ASSERT_TRUE(outlet.ring().pop(popped));
        for (const TickResult& got : {popped, outlet.latest(0).read()}) {
            EXPECT_EQ(got.tick, tick);
            ASSERT_EQ(got.active_contacts().size(), 2U);
            EXPECT_EQ(got.contacts[0].force, seen);
            EXPECT_EQ(got.contacts[1].force, seen);
            EXPECT_EQ(got.contacts[2].force, 0);
        }
    }
}

TEST(ServoLoop, each_tool_has_its_device_and_its_results) {
    HapticModel model(sample::sample_case(), "continuous", 2);
    RecordingDevice pressing;
    devices::GuidedDevice away({{0, 0, 60}}, {}, 200);
    const std::array<Device*, 2> devices{&pressing, &away};
    ServoLoop loop(model, devices);
    std::array<double, 2> strongest{0, 0};
    loop.run_virtual(20, [&](const TickResult& result) {
        double& force = strongest[static_cast<std::size_t>(result.tool)];
        force = std::max(force, result.force[2]);
    });
    EXPECT_GT(strongest[0], 0.3);
    EXPECT_EQ(strongest[1], 0);
    EXPECT_EQ(loop.latest(0).read().tool, 0);
    EXPECT_EQ(loop.latest(1).read().tool, 1);
}

TEST(ServoLoop, a_full_ring_loses_records_and_counts_them) {
    HapticModel model(sample::sample_case());
    RecordingDevice device;
    ServoLoop loop(model, device, 4);
    loop.run_virtual(10, [](const TickResult&) {});
    EXPECT_EQ(loop.statistics().ticks, 10);
    EXPECT_EQ(loop.statistics().lost_records, 6U);
}

// A servo that ticks when it is told to, with what it is told.
class HandServo final : public Servo {
  public:
    void start(OnTick on_tick) override { tick = std::move(on_tick); }
    void stop() override {}
    OnTick tick;
};

// A loop on a device that presses the skull, ticked by hand.
class PressedLoop : public ::testing::Test {
  protected:
    void SetUp() override {
        loop_.start();
        run(40);
        ASSERT_GT(device_.force_[2], 0.3);
    }
    void TearDown() override { loop_.stop(); }
    void run(int ticks) {
        for (int i = 0; i < ticks; ++i) servo_.tick({1e-3 * ++ticks_, latency_ns_, overruns_});
    }
    std::uint32_t faults() { return loop_.latest().read().faults; }

    HapticModel model_{sample::sample_case()};
    RecordingDevice device_;
    std::array<Device*, 1> devices_{&device_};
    HandServo servo_;
    ServoLoop loop_{model_, devices_, &servo_};
    int ticks_ = 0;
    std::int64_t overruns_ = 0, latency_ns_ = 0;
};

TEST_F(PressedLoop, a_pause_of_ten_periods_takes_the_force_to_zero_and_brings_it_back) {
    const double pressed = device_.force_[2];
    overruns_ = ServoLoop::late_periods - 1;
    run(1);
    EXPECT_EQ(faults(), no_fault);
    overruns_ += ServoLoop::late_periods;
    run(1);
    EXPECT_EQ(faults(), tick_late);
    run(ForceLimiter::ramp_ticks - 1);
    EXPECT_EQ(device_.force_[2], 0);
    run(ForceLimiter::return_ticks + 1);
    EXPECT_NEAR(device_.force_[2], pressed, 1e-9);
}

TEST_F(PressedLoop, the_tick_that_wakes_late_is_the_first_without_its_force) {
    latency_ns_ = ServoLoop::late_periods * ServoLoop::period_ns - 1;
    run(1);
    EXPECT_EQ(faults(), no_fault);
    const double pressed = device_.force_[2];
    ++latency_ns_;
    run(1);
    EXPECT_EQ(faults(), tick_late);
    EXPECT_LT(device_.force_[2], pressed);
}

TEST_F(PressedLoop, a_fault_told_from_outside_lasts_until_it_is_taken_back) {
    loop_.set_fault(asset_removed, true);
    run(100);
    EXPECT_EQ(faults(), asset_removed);
    EXPECT_EQ(device_.force_[2], 0);
    loop_.set_fault(asset_removed, false);
    run(ForceLimiter::ramp_ticks + 10);
    EXPECT_EQ(faults(), no_fault);
    EXPECT_GT(device_.force_[2], 0);
}

TEST_F(PressedLoop, a_window_that_stops_drawing_is_missed_once_it_has_drawn) {
    run(1);
    EXPECT_EQ(faults(), no_fault);
    loop_.visual_beat();
    run(1);
    EXPECT_EQ(faults(), no_fault);
    std::this_thread::sleep_for(std::chrono::nanoseconds(ServoLoop::visual_patience_ns));
    run(ForceLimiter::ramp_ticks);
    EXPECT_EQ(faults(), visual_stopped);
    EXPECT_EQ(device_.force_[2], 0);
    loop_.visual_beat();
    run(1);
    EXPECT_EQ(faults(), no_fault);
}

TEST(ServoLoop, a_collision_loop_that_stops_takes_the_force_away) {
    HapticModel model(sample::sample_case(), "single");
    DeviceState pressing;
    pressing.position = {40, 10, 24.5};
    TickResult result{};
    model.tick(pressing, result);
    model.detect();
    for (int tick = 0; tick < 100; ++tick) model.tick(pressing, result);
    EXPECT_GT(result.force[2], 0.15);  // a point 0.5 mm deep behind 0.4 N/mm
    EXPECT_EQ(result.faults, no_fault);
    for (int tick = 0; tick < 1 + ForceLimiter::ramp_ticks; ++tick) model.tick(pressing, result);
    EXPECT_EQ(result.faults, collision_stale);
    EXPECT_EQ(result.force[2], 0);
}

TEST(ServoLoop, ends_with_a_servo_that_does_not_tick_any_more) {
    HapticModel model(sample::sample_case());
    RecordingDevice device;
    HandServo servo;
    const std::array<Device*, 1> devices{&device};
    ServoLoop loop(model, devices, &servo);
    loop.start();
    loop.stop();
    EXPECT_EQ(loop.statistics().ticks, 0);
}

TEST(ServoLoop, leaves_the_device_without_force) {
    HapticModel model(sample::sample_case());
    RecordingDevice device;
    ServoLoop loop(model, device);
    double strongest = 0;
    loop.run_virtual(20, [&](const TickResult& result) { strongest = std::max(strongest, result.force[2]); });
    EXPECT_GT(strongest, 0.3);
    EXPECT_EQ(device.force_, (std::array<double, 3>{0, 0, 0}));
}

}  // namespace
}  // namespace palpate
