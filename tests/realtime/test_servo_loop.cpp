// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <gtest/gtest.h>
#include <thread>

#include "runtime/devices/guided_device.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

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
    void write(const std::array<double, 3>& force) noexcept override { force_ = force; }
    std::array<double, 3> force_{9, 9, 9};
};

TEST(ServoLoop, every_tick_reaches_the_logger_and_the_latest_the_screen) {
    HapticModel model(sample::sample_case());
    GuidedDevice device({40, 10, 32}, {}, 200);
    ServoLoop loop(model, device, 1024);
    loop.start();
    device.set_target({40, 10, 25});
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
    HapticModel model(sample::sample_case(), ContactScheme::twice);
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

TEST(ServoLoop, each_tool_has_its_device_and_its_results) {
    HapticModel model(sample::sample_case(), ContactScheme::continuous, 2);
    RecordingDevice pressing;
    GuidedDevice away({0, 0, 60}, {}, 200);
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
