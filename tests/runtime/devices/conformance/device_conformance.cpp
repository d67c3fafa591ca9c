// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/devices/conformance/device_conformance.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "runtime/haptics/servo_loop.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/allocation_trap.hpp"

namespace palpate::conformance {
namespace {

using namespace devices;
using namespace haptics;
using namespace realtime;
using Eigen::Vector3d;

// A hand of 0.3 N/mm lags its path by a Touch's friction, 0.26 N, by what damping takes, and by a grain of
// the encoders: less than this, mm.
constexpr double hand_gives_way = 1.5;

const HandPath at_rest({{0, {5, -3, 8}}});
const HandPath moving({{0, {5, -3, 8}}, {0.4, {5, -3, 8}}, {1.4, {17, -11, 13}}});

Vector3d position_of(const DeviceState& state) {
    return Eigen::Map<const Vector3d>(state.position.data());
}

// What one tick of the devices saw.
struct Seen {
    double time = 0;
    std::array<DeviceState, 2> states{};
};

// Ticks the devices until their time is over, writing these forces; every tick as it was seen.
std::vector<Seen> run(OpenDevices& open, double seconds,
                      const std::array<std::array<double, 3>, 2>& forces = {}) {
    std::vector<Seen> seen;
    seen.reserve(static_cast<std::size_t>(2000 * seconds) + 1000);
    std::atomic<bool> over{false};
    open.servo().start([&](const ServoTick& wake) {
        if (over) return;
        Seen now;
        now.time = open.time(wake);
        for (std::size_t d = 0; d < open.devices().size(); ++d) {
            now.states[d] = open.devices()[d]->read(wake.time);
            open.devices()[d]->write({forces[d]});
        }
        if (seen.size() < seen.capacity()) seen.push_back(now);
        if (now.time >= seconds || seen.size() == seen.capacity()) over = true;
    });
    while (!over) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    open.servo().stop();
    return seen;
}

// As a tick takes them: that a position is not a number, it sees for itself.
std::uint32_t faults_of(const DeviceState& state) {
    return state.faults | (position_of(state).allFinite() ? no_fault : invalid_position);
}

std::uint32_t faults_within(const std::vector<Seen>& seen, double from, double until) {
    std::uint32_t faults = no_fault;
    for (const Seen& now : seen)
        if (now.time >= from && now.time < until) faults |= faults_of(now.states[0]);
    return faults;
}

// A device that remembers the force it was given last.
class WitnessedDevice final : public Device {
  public:
    explicit WitnessedDevice(std::unique_ptr<Device> device) : device_(std::move(device)) {}
    std::string name() const override { return device_->name(); }
    DeviceLimits limits() const override { return device_->limits(); }
    Calibration calibration() override { return device_->calibration(); }
    void calibrate() override { device_->calibrate(); }
    DeviceState read(double time) noexcept override { return device_->read(time); }
    void write(const Wrench& wrench) noexcept override {
        force_ = wrench.force;
        device_->write(wrench);
    }
    std::array<double, 3> force_{0, 0, 0};

  private:
    std::unique_ptr<Device> device_;
};

class PeriodicDevices final : public OpenDevices {
  public:
    explicit PeriodicDevices(std::vector<std::unique_ptr<Device>> devices) {
        for (auto& device : devices) {
            witnessed_.push_back(std::make_unique<WitnessedDevice>(std::move(device)));
            devices_.push_back(witnessed_.back().get());
        }
    }
    std::span<Device* const> devices() override { return devices_; }
    Servo& servo() override { return servo_; }
    std::array<double, 3> force(std::size_t device) override { return witnessed_[device]->force_; }

  private:
    std::vector<std::unique_ptr<WitnessedDevice>> witnessed_;
    std::vector<Device*> devices_;
    PeriodicServo servo_;
};

}  // namespace

std::unique_ptr<OpenDevices> with_periodic_servo(std::vector<std::unique_ptr<Device>> devices) {
    return std::make_unique<PeriodicDevices>(std::move(devices));
}

// Not every build has a backend for each suite.
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(ButtonConformance);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(FaultConformance);

TEST_P(DeviceConformance, opens_and_closes_again_and_again_with_the_same_name) {
    std::string name;
    for (int time = 0; time < 2; ++time) {
        const auto open = GetParam().open({{at_rest}});
        ASSERT_EQ(open->devices().size(), 1U);
        const std::string now = open->devices()[0]->name();
        EXPECT_FALSE(now.empty());
        if (name.empty()) name = now;
        EXPECT_EQ(now, name);
        EXPECT_FALSE(run(*open, 0.05).empty());
    }
}

TEST_P(DeviceConformance, states_limits_that_a_device_can_have) {
    const DeviceLimits limits = GetParam().open({{at_rest}})->devices()[0]->limits();
    EXPECT_GT(limits.max_force, 0);
    for (const double figure : {limits.max_force, limits.max_stiffness, limits.damping,
                                limits.max_continuous_force, limits.rate_hz}) {
        EXPECT_TRUE(std::isfinite(figure));
        EXPECT_GE(figure, 0);
    }
    EXPECT_LE(limits.max_continuous_force, limits.max_force);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LE(limits.workspace_low[k], limits.workspace_high[k]);
}

TEST_P(DeviceConformance, knows_where_it_is_once_calibrated) {
    const auto open = GetParam().open({{at_rest}});
    open->devices()[0]->calibrate();
    EXPECT_EQ(open->devices()[0]->calibration(), Calibration::ok);
}

TEST_P(DeviceConformance, follows_the_hand_in_mm_with_each_axis_where_it_belongs) {
    const auto open = GetParam().open({{moving}});
    const std::vector<Seen> seen = run(*open, 1.6);
    ASSERT_GT(seen.size(), 100U);
    for (const Seen& now : seen) {
        EXPECT_LT((position_of(now.states[0]) - moving.at(now.time)).norm(), hand_gives_way) << now.time;
        EXPECT_EQ(now.states[0].faults, no_fault) << fault_names(now.states[0].faults);
        const double shaft = Eigen::Map<const Vector3d>(now.states[0].shaft.data()).norm();
        EXPECT_TRUE(shaft == 0 || std::abs(shaft - 1) < 1e-9) << shaft;
    }
}

TEST_P(DeviceConformance, two_thousand_ticks_allocate_nothing) {
    const auto open = GetParam().open({{moving}, {at_rest}});
    std::atomic<int> ticks{0};
    std::atomic<std::size_t> allocations{0};
    double last = -1;
    bool rising = true;
    open->servo().start([&](const ServoTick& wake) {
        const AllocationTrap trap;
        for (Device* device : open->devices()) {
            device->read(wake.time);
            device->write({{0.1, 0, 0}});
        }
        allocations += trap.count();
        rising = rising && wake.time > last;
        last = wake.time;
        ++ticks;
    });
    while (ticks < 2000) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    open->servo().stop();
    EXPECT_EQ(allocations, 0U);
    EXPECT_TRUE(rising);
    const int then = ticks;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(ticks, then);  // none comes after stop()
}

TEST_P(DeviceConformance, two_devices_do_not_mix) {
    const auto open = GetParam().open({{at_rest}, {HandPath({{0, {-20, 10, 1}}})}});
    ASSERT_EQ(open->devices().size(), 2U);
    const std::vector<Seen> seen = run(*open, 0.6, {{{0, 0, 0}, {0, 1.2, 0}}});
    const Seen& last = seen.back();
    EXPECT_LT((position_of(last.states[0]) - at_rest.at(0)).norm(), 0.1);  // a grain of the encoders
    EXPECT_NEAR(position_of(last.states[1]).x(), -20, 0.1);
    EXPECT_EQ(open->force(0), (std::array<double, 3>{0, 0, 0}));
}

TEST_P(DeviceConformance, no_force_stands_after_the_loop_has_stopped) {
    // Into the skull's top, whose contact is at z = 26.5 mm.
    const auto open =
        GetParam().open({{HandPath({{0, {40, 10, 30}}, {0.3, {40, 10, 30}}, {0.6, {40, 10, 22}}})}});
    HapticModel model(sample::sample_case());
    ServoLoop loop(model, open->devices(), &open->servo());
    loop.start();
    TickResult latest;
    do {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        latest = loop.latest().read();
    } while (latest.force[2] < 0.5 && latest.time < 3);
    EXPECT_GT(latest.force[2], 0.5) << fault_names(latest.faults);
    loop.stop();
    latest = loop.latest().read();
    EXPECT_EQ(latest.faults, servo_stopping) << fault_names(latest.faults);
    EXPECT_EQ(latest.force, (std::array<double, 3>{0, 0, 0}));
    EXPECT_EQ(open->force(0), (std::array<double, 3>{0, 0, 0}));
}

TEST_P(DeviceConformance, callbacks_run_in_its_servo) {
    const auto open = GetParam().open({{at_rest}});
    HapticModel model(sample::sample_case());
    ServoLoop loop(model, open->devices(), &open->servo());
    loop.start();
    struct Calls {
        int count = 0;
        std::array<std::thread::id, 3> threads{};
    } calls;
    EXPECT_TRUE(loop.callbacks().run(
        [](void* data) noexcept {
            auto& c = *static_cast<Calls*>(data);
            c.threads[static_cast<std::size_t>(c.count++)] = std::this_thread::get_id();
            return c.count < 3 ? ServoCallbacks::Then::again : ServoCallbacks::Then::done;
        },
        &calls));
    loop.stop();
    EXPECT_EQ(calls.count, 3);
    EXPECT_NE(calls.threads[0], std::this_thread::get_id());
    EXPECT_EQ(calls.threads[0], calls.threads[2]);
}

TEST_P(ButtonConformance, each_button_arrives_at_its_bit_and_is_released) {
    const auto open = GetParam().open({{at_rest, {{0, 0.3, 0.5}, {1, 0.4, 0.6}}}});
    const std::vector<Seen> seen = run(*open, 0.8);
    const double tick = 0.0015;  // one and a half: a state may be of the tick before
    for (const Seen& now : seen) {
        const auto expected = [](double time) {
            return (time >= 0.3 && time < 0.5 ? 1U : 0U) | (time >= 0.4 && time < 0.6 ? 2U : 0U);
        };
        if (expected(now.time - tick) != expected(now.time + tick)) continue;
        EXPECT_EQ(now.states[0].buttons, expected(now.time)) << now.time;
    }
}

TEST_P(ForceConformance, a_force_moves_the_tip_its_way) {
    // 1.5 N against 0.3 N/mm and 0.26 N of friction: 4.1 mm; crosswise, friction may hold what it holds.
    const std::array<std::array<double, 3>, 3> forces{{{1.5, 0, 0}, {0, -1.5, 0}, {0, 0, 1.5}}};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto open = GetParam().open({{at_rest}});
        const Vector3d moved = position_of(run(*open, 0.8, {forces[k]}).back().states[0]) - at_rest.at(0);
        const auto axis = static_cast<Eigen::Index>(k);
        EXPECT_GT(moved[axis] * (forces[k][k] > 0 ? 1 : -1), 3) << moved.transpose();
        EXPECT_LT(std::sqrt(moved.squaredNorm() - moved[axis] * moved[axis]), 1) << moved.transpose();
    }
}

TEST_P(FaultConformance, appears_as_its_flag_alone_and_vanishes) {
    const FaultCase& p = GetParam();
    const double from = 0.5, until = 1.0, end = until + p.patience + 0.2;
    const auto open = p.backend.open({{at_rest, {}, {{p.fault, from, until}}}});
    const std::vector<Seen> seen = run(*open, end, {{{0.3, 0, 0}, {}}});
    EXPECT_EQ(faults_within(seen, 0, from), no_fault) << fault_names(faults_within(seen, 0, from));
    EXPECT_EQ(faults_within(seen, from, end), p.flag) << fault_names(faults_within(seen, from, end));
    const std::uint32_t after = faults_within(seen, until + p.patience, end);
    EXPECT_EQ(after, no_fault) << fault_names(after);
    for (const Seen& now : seen) {
        if (now.time < from + p.patience || now.time >= until) continue;
        EXPECT_EQ(faults_of(now.states[0]), p.flag)
            << now.time << " s: " << fault_names(faults_of(now.states[0]));
    }
}

}  // namespace palpate::conformance
