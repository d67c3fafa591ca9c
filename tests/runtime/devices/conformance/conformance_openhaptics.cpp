// SPDX-License-Identifier: Apache-2.0
// The OpenHaptics backend on the conformance library.
#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "formats/model/geometry/rotations.hpp"
#include "runtime/devices/dynamics/dynamic_device.hpp"
#include "runtime/devices/openhaptics/hd_session.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/devices/conformance/device_conformance.hpp"
#include "tests/runtime/devices/openhaptics/hd_library/hd_functions.hpp"
#include "tests/runtime/elastic_cube.hpp"

namespace palpate::conformance {
namespace {

using namespace devices;
using namespace haptics;
using namespace realtime;
using nlohmann::json;

std::string library_path() {
    return PALPATE_HD_CONFORMANCE;
}

const hd::Functions& library() {
    static const hd::Functions functions(library_path());
    return functions;
}

void configure(const json& script) {
    if (const char* message = library().configure(script.dump().c_str())) throw std::runtime_error(message);
}

// A wish keeps to keys at whole tenths of a second.
json keys_of(const HandPath& path) {
    json keys = json::array();
    const int steps = std::max(1, static_cast<int>(std::ceil(path.duration() / 0.1)));
    for (int step = 0; step <= steps; ++step) {
        const double time = 0.1 * step;
        const Eigen::Vector3d p = path.at(time);
        keys.push_back({time, p.x(), p.y(), p.z()});
    }
    return keys;
}

json device_of(const std::string& name, const DeviceWish& wish) {
    json device{{"name", name}, {"model", "touch"}, {"path", keys_of(wish.path)}, {"styles", {"inkwell"}}};
    for (const Press& press : wish.presses)
        device["buttons"].push_back({{"button", press.button}, {"from", press.from}, {"until", press.until}});
    for (const Mishap& mishap : wish.mishaps)
        device["faults"].push_back({{"fault", mishap.fault}, {"from", mishap.from}, {"until", mishap.until}});
    return device;
}

class HdDevices final : public OpenDevices {
  public:
    HdDevices(const json& script, std::vector<std::string> names)
        : session_((configure(script), HdSettings{library_path(), std::move(names)})) {}

    std::span<Device* const> devices() override { return session_.devices(); }
    Servo& servo() override { return session_.servo(); }
    double time(const ServoTick&) override { return library().hardware(0).time; }
    std::array<double, 3> force(std::size_t device) override {
        const hd::Hardware at = library().hardware(static_cast<hd::Handle>(device));
        return {at.asked[0], at.asked[1], at.asked[2]};
    }

  private:
    HdSession session_;
};

std::unique_ptr<OpenDevices> open_openhaptics(const std::vector<DeviceWish>& wishes) {
    json script{{"clock", "real"}, {"devices", json::array()}};
    std::vector<std::string> names;
    for (const DeviceWish& wish : wishes) {
        names.push_back("device " + std::to_string(names.size()));
        script["devices"].push_back(device_of(names.back(), wish));
    }
    return std::make_unique<HdDevices>(script, names);
}

const Backend openhaptics{"openhaptics", open_openhaptics};

FaultCase fault(const char* name, Fault flag, double patience = 0.020) {
    return {openhaptics, name, flag, patience};
}

INSTANTIATE_TEST_SUITE_P(OpenHaptics, DeviceConformance, testing::Values(openhaptics), backend_name);
INSTANTIATE_TEST_SUITE_P(OpenHaptics, ButtonConformance, testing::Values(openhaptics), backend_name);
INSTANTIATE_TEST_SUITE_P(OpenHaptics, ForceConformance, testing::Values(openhaptics), backend_name);
INSTANTIATE_TEST_SUITE_P(
    OpenHaptics, FaultConformance,
    testing::Values(
        fault("warm_motors", motors_warm, 0.2),  // a temperature has no hurry, and is asked for now and then
        fault("comm_error", device_lost), fault("disconnect", device_lost),
        fault("not_a_number", invalid_position),
        fault("frozen_pose", pose_frozen, 0.2),  // a hand may rest there for a moment
        fault("max_force", device_refused), fault("velocity", device_refused),
        fault("impulse", device_refused), fault("timer_error", tick_late),
        fault("calibration_lost", not_calibrated, 0.2),  // asked for now and then, as drivers advise
        fault("frame_failure", device_lost)),
    fault_case_name);

// What an opening that the library refuses says.
std::string refusal_of(const char* refusal) {
    configure({{"devices", {{{"name", "Default Device"}, {"refuse", refusal}}}}});
    try {
        HdSession session(HdSettings{library_path(), {}});
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}

TEST(OpenHaptics, opens_the_default_device_where_none_is_named) {
    configure(json{{"devices", {{{"name", "Default Device"}}}}});
    HdSession session(HdSettings{library_path(), {}});
    EXPECT_EQ(session.devices().size(), 1U);
}

TEST(OpenHaptics, each_refusal_has_words_of_its_own) {
    std::vector<std::string> words;
    for (const char* refusal : {"comm", "comm_config", "licence", "already_initiated"}) {
        words.push_back(refusal_of(refusal));
        EXPECT_FALSE(words.back().empty()) << refusal;
    }
    std::ranges::sort(words);
    EXPECT_EQ(std::ranges::adjacent_find(words), words.end());
}

TEST(OpenHaptics, an_old_calibration_is_brought_up_to_date_and_a_missing_one_told) {
    configure(json{{"devices", {{{"name", "A"}, {"calibration", "needs_update"}}}}});
    {
        HdSession session(HdSettings{library_path(), {"A"}});
        EXPECT_EQ(session.devices()[0]->calibration(), Calibration::ok);
    }
    configure(
        json{{"devices", {{{"name", "A"}, {"calibration", "needs_manual_input"}, {"styles", {"inkwell"}}}}}});
    EXPECT_THROW(HdSession(HdSettings{library_path(), {"A"}}), SystemFailure);
}

TEST(OpenHaptics, a_standstill_of_the_servo_counts_as_overruns) {
    json device = device_of("A", {HandPath({{0, {5, -3, 8}}}), {}, {{"scheduler_stall", 0.3, 0.4}}});
    HdDevices open(json{{"clock", "real"}, {"devices", {device}}}, {"A"});
    std::atomic<std::int64_t> worst{0}, last{0};
    std::atomic<bool> over{false};
    open.servo().start([&](const ServoTick& wake) {
        open.devices()[0]->read(wake.time);
        open.devices()[0]->write({});
        worst = std::max<std::int64_t>(worst, wake.overruns - last);
        last = wake.overruns;
        if (open.time(wake) > 0.5) over = true;
    });
    while (!over) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    open.servo().stop();
    // 100 periods, or fewer by those for which the tick before the standstill was late itself.
    EXPECT_GE(worst, ServoLoop::late_periods);
}

// Turns the stylus through the whole driver: what was asked for in frame D is what its hand bears.
TEST(OpenHaptics, a_gimbal_with_motors_is_turned) {
    HdDevices open(json{{"clock", "virtual"},
                        {"pause_after_ticks", 3000},
                        {"devices", {{{"name", "A"}, {"model", "premium-6dof"}, {"shaft", {0, 0, 1}}}}}},
                   {"A"});
    Device& device = *open.devices()[0];
    EXPECT_EQ(device.limits().max_torque, find_device_model("premium-6dof").max_torque);
    const Eigen::Vector3d torque(20, -40, 30);  // N mm
    std::array<double, 4> orientation{};
    std::uint32_t faults = no_fault;
    open.servo().start([&](const ServoTick& wake) {
        const DeviceState state = device.read(wake.time);
        orientation = state.orientation;
        faults |= state.faults;
        device.write({{0, 0, 0}, array_of(torque)});
    });
    while (library().hardware(0).time < 2.9) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    open.servo().stop();
    EXPECT_EQ(faults, no_fault);
    const Eigen::Vector3d turn = rotation_between(Eigen::Quaterniond::Identity(), quaternion_of(orientation));
    EXPECT_LT((turn - torque / HandImpedance{}.torsional_stiffness).norm(), 1e-6);
}

// A device that another one's read is timed by, or that reads at a shifted time; both as seen by a loop.
class Forwarding : public Device {
  public:
    explicit Forwarding(Device& device) : device_(device) {}
    std::string name() const override { return device_.name(); }
    DeviceLimits limits() const override { return device_.limits(); }
    Calibration calibration() override { return device_.calibration(); }
    void calibrate() override { device_.calibrate(); }
    DeviceState read(double time) noexcept override { return device_.read(time); }
    void write(const Wrench& wrench) noexcept override { device_.write(wrench); }

  private:
    Device& device_;
};

// Tells when, on the device's own clock, the loop's time was zero.
class TimedDevice final : public Forwarding {
  public:
    using Forwarding::Forwarding;
    DeviceState read(double time) noexcept override {
        if (std::isnan(shift_)) shift_ = library().hardware(0).time - time;
        return Forwarding::read(time);
    }
    double shift_ = std::nan("");
};

class ShiftedDevice final : public Forwarding {
  public:
    ShiftedDevice(Device& device, double shift, const DeviceLimits& limits)
        : Forwarding(device), shift_(shift), limits_(limits) {}
    DeviceLimits limits() const override { return limits_; }
    DeviceState read(double time) noexcept override { return Forwarding::read(time + shift_); }

  private:
    double shift_;
    DeviceLimits limits_;
};

// Presses and slides on the skull's top (z = 25 mm), then on the cube's (20 mm), with a tool of 1.5 mm.
const std::vector<HandPath::Key> session_keys{{0, {40, 10, 32}},   {0.6, {40, 10, 32}}, {1.0, {40, 10, 22}},
                                              {1.6, {44, 12, 22}}, {2.2, {36, 8, 22}},  {2.5, {38, 10, 32}},
                                              {3.1, {10, 10, 32}}, {3.5, {10, 10, 17}}, {4.0, {13, 12, 17}},
                                              {4.6, {7, 9, 16}},   {5.0, {10, 10, 32}}};
constexpr int session_ticks = 5000;

Case session_case() {
    Case patient_case = sample::sample_case();
    patient_case.deformable_bodies = {sample::true_elastic_cube(4)};
    return patient_case;
}

// A servo whose ticks are in time: on a virtual clock, what the machine does meanwhile is not late.
class OnTimeServo final : public Servo {
  public:
    explicit OnTimeServo(Servo& servo) : servo_(servo) {}
    void start(OnTick on_tick) override {
        servo_.start([on_tick](const ServoTick& wake) { on_tick({wake.time, 0, 0}); });
    }
    void stop() override { servo_.stop(); }

  private:
    Servo& servo_;
};

// Every tick of the session through the driver's interface, on its virtual clock.
struct Session {
    std::vector<TickResult> ticks;
    double shift = 0;
    DeviceLimits limits;
};
Session run_through_the_library() {
    json keys = json::array();
    json device{{"name", "A"}, {"model", "touch"}};
    for (const HandPath::Key& key : session_keys)
        keys.push_back({key.time, key.position.x(), key.position.y(), key.position.z()});
    device["path"] = keys;
    HdDevices open(json{{"clock", "virtual"}, {"pause_after_ticks", session_ticks}, {"devices", {device}}},
                   {"A"});
    TimedDevice timed(*open.devices()[0]);
    HapticModel model(session_case());
    OnTimeServo servo(open.servo());
    ServoLoop loop(model, std::array<Device*, 1>{&timed}, &servo, 8192);
    loop.start();
    while (library().hardware(0).time < 1e-3 * session_ticks - 1e-6)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    loop.stop();
    Session session;
    session.shift = timed.shift_;
    session.limits = timed.limits();
    TickResult tick;
    while (loop.ring().pop(tick)) session.ticks.push_back(tick);
    return session;
}

TEST(OpenHaptics, same_session) {
    const Session through = run_through_the_library();
    ASSERT_GT(through.ticks.size(), 4900U);
    DynamicDevice touch(find_device_model("touch"), HandImpedance{}, HandPath(session_keys), {0, 0, 1});
    ShiftedDevice direct(touch, through.shift, through.limits);
    HapticModel model(session_case());
    ServoLoop loop(model, std::array<Device*, 1>{&direct}, nullptr, 16);
    std::size_t tick = 0, pressing = 0;
    double worst = 0;
    loop.run_virtual(static_cast<std::int64_t>(through.ticks.size()), [&](const TickResult& here) {
        const TickResult& there = through.ticks[tick++];
        ASSERT_EQ(here.tick, there.tick);
        ASSERT_EQ(there.faults, no_fault) << tick << ": " << fault_names(there.faults);
        for (std::size_t k = 0; k < 3; ++k) worst = std::max(worst, std::abs(here.force[k] - there.force[k]));
        if (Eigen::Map<const Eigen::Vector3d>(there.force.data()).norm() > 0.01) ++pressing;
    });
    EXPECT_GT(pressing, 2000U);
    EXPECT_LE(worst, 1e-9);
    RecordProperty("worst_force_difference_n", testing::PrintToString(worst));
}

}  // namespace
}  // namespace palpate::conformance
