// SPDX-License-Identifier: Apache-2.0
// A replay gives the forces and torques of a run again, bit for bit, from its start or from wherever it can
// be taken up.
#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "runtime/devices/hand_path.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "runtime/session/replay.hpp"
#include "runtime/session/run_recorder.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/runtime/haptics/held_tool.hpp"
#include "tests/runtime/samples.hpp"

namespace palpate {
namespace {

using namespace devices;
using namespace haptics;
using namespace realtime;
using namespace recording;
using namespace session;
using Eigen::Vector3d;

// A ball beside an elastic cube, of which both have edges and corners right under the hand's way, with
// friction, under a tool with a shaft.
Case ball_and_cube() {
    Case c = soft_cube(4);
    c.rigid_bodies.push_back(rigid("ball", sample::sphere_surface({30, 10, 14}, 8, 4)));
    c.haptics = {.tool_radius = 1.5,
                 .coupling_stiffness = 0.5,
                 .max_force = 3.3,
                 .max_force_rate = 0.5,
                 .friction_at_rest = 0.3,
                 .friction_sliding = 0.2,
                 .shaft_length = 6};
    return c;
}

// In and out and along, over both bodies.
HandPath wandering(unsigned seed, double seconds) {
    std::mt19937 random(seed);
    const auto between = [&](double a, double b) {
        return std::uniform_real_distribution<double>(a, b)(random);
    };
    std::vector<HandPath::Key> keys{{0, {12, 10, 30}}};
    while (keys.back().time < seconds)
        keys.push_back(
            {keys.back().time + between(0.05, 0.3), {between(3, 35), between(2, 18), between(17, 32)}});
    return HandPath(std::move(keys));
}

// The same way by a tool that turns, up to some 50 degrees off the vertical.
HandPath turning(const HandPath& path, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> tilt(-0.4, 0.4);
    std::vector<HandPath::Key> keys(path.keys().begin(), path.keys().end());
    for (HandPath::Key& key : keys) {
        const double x = tilt(random), y = tilt(random), z = tilt(random);  // in this order by every compiler
        key.orientation = Eigen::Quaterniond(1, x, y, z).normalized();
    }
    return HandPath(std::move(keys));
}

// A device that fails now and then, in each of the ways that a model takes differently.
class Unreliable final : public Device {
  public:
    explicit Unreliable(HandPath path) : hand_(std::move(path), {.max_force = 2}, {0, 0, 1}) {}

    std::string name() const override { return hand_.name(); }
    DeviceLimits limits() const override { return hand_.limits(); }
    DeviceState read(double time) noexcept override {
        DeviceState state = hand_.read(time);
        state.buttons = ++ticks_ % 2;
        const unsigned phase = ticks_ % 2000;
        if (phase > 700 && phase < 720) state.faults = motors_warm;
        if (phase > 1300 && phase < 1310) state.position[1] = std::numeric_limits<double>::quiet_NaN();
        if (phase > 1900 && phase < 1905) state.faults = pose_frozen;
        return state;
    }
    void write(const Wrench&) noexcept override {}

  private:
    SimulatedDevice hand_;
    unsigned ticks_ = 0;
};

struct Trial {
    std::string_view name;
    // Made by the test that takes it: a list of cases would be made again by every test of the room.
    Case (*patient_case)();
    std::string_view scheme;
    std::size_t tools;
    std::int64_t ticks;
    bool turns = false;  // as its hand wishes

    friend void PrintTo(const Trial& trial, std::ostream* out) { *out << trial.name; }
};

// The rows of a run, and its model's limits.
Recording record(const Trial& trial, const sample::Scratch& scratch) {
    const Case patient_case = trial.patient_case();
    HapticModel model(patient_case, trial.scheme, trial.tools);
    std::vector<std::unique_ptr<Unreliable>> devices;
    std::vector<Device*> held;
    for (std::size_t t = 0; t < trial.tools; ++t) {
        const auto seed = static_cast<unsigned>(7 + t);
        const HandPath path = wandering(seed, 1e-3 * static_cast<double>(trial.ticks));
        devices.push_back(std::make_unique<Unreliable>(trial.turns ? turning(path, seed) : path));
        held.push_back(devices.back().get());
    }
    ServoLoop loop(model, held);
    RecordingHead head{.palpate_version = "0",
                       .case_name = patient_case.name,
                       .asset_digest = "0",
                       .scheme = std::string(trial.scheme),
                       .clock = "virtual",
                       .coupling_stiffness = model.coupling(),
                       .haptics = patient_case.haptics,
                       .devices = {}};
    for (const Device* device : held) head.devices.push_back({device->name(), {.max_force = 2}});
    const auto path = scratch / "run.h5";
    make_recording(path, head, (trial.ticks + 1) * static_cast<std::int64_t>(trial.tools));
    RunRecorder recorder(path);
    loop.run_virtual(trial.ticks, [&](const TickResult& result) {
        // As if another thread told of a fault now and then.
        loop.set_fault(visual_stopped, result.tick % 4000 > 3950);
        recorder.add(result);
    });
    return read_recording(path);
}

// A fresh model, as that of the run.
std::unique_ptr<HapticModel> model_for(const Trial& trial, const Recording& recording) {
    auto model = std::make_unique<HapticModel>(trial.patient_case(), trial.scheme, trial.tools);
    std::vector<DeviceLimits> limits;
    for (const RecordedDevice& device : recording.head.devices) limits.push_back(device.limits);
    model->couple_to(limits);
    return model;
}

ReplayOutcome replayed(const Recording& recording, HapticModel& model) {
    return replay(recording, model, [](const TickResult&) {});
}
ReplayOutcome replayed(const Trial& trial, const Recording& recording) {
    return replayed(recording, *model_for(trial, recording));
}

// Some rows of it, as where a ring has wrapped.
Recording part_of(const Recording& whole, std::size_t first_row, std::size_t rows) {
    const auto all = std::span(whole.ticks).subspan(first_row);
    const auto some = all.first(std::min(rows, all.size()));
    Recording part;
    part.head = whole.head;
    part.ticks.assign(some.begin(), some.end());
    return part;
}

class Replay : public testing::TestWithParam<Trial> {};

TEST_P(Replay, from_the_start_gives_the_same_forces) {
    const sample::Scratch scratch;
    const Recording recording = record(GetParam(), scratch);
    const ReplayOutcome outcome = replayed(GetParam(), recording);
    EXPECT_EQ(outcome.ticks, GetParam().ticks);
    EXPECT_EQ(outcome.different_ticks, 0);
    EXPECT_EQ(outcome.started, 0);
    EXPECT_EQ(outcome.missing_ticks, 0);
}

TEST_P(Replay, from_a_free_tick_in_the_middle_gives_the_same_forces) {
    const sample::Scratch scratch;
    const Recording recording = record(GetParam(), scratch);
    std::int64_t compared = 0, in_contact = 0;
    for (const Tick& row : recording.ticks) in_contact += row.contact_count > 0;
    ASSERT_GT(in_contact, GetParam().ticks / 20);
    // One model for all parts, which a replay resets: to build a shell's takes longer than its ticks.
    const auto model = model_for(GetParam(), recording);
    for (std::size_t first = 101; first < recording.ticks.size(); first += sanitized ? 388 : 97) {
        const ReplayOutcome outcome = replayed(part_of(recording, first, 1000), *model);
        if (!outcome.started) continue;
        compared += outcome.ticks;
        ASSERT_EQ(outcome.different_ticks, 0)
            << "without the first " << first << " rows, tick " << outcome.first_difference->tick
            << " is off by up to " << outcome.largest_difference << " N, "
            << outcome.largest_torque_difference << " N mm";
    }
    EXPECT_GT(compared, (sanitized ? 1 : 5) * GetParam().ticks);
}

TEST_P(Replay, goes_on_behind_lost_rows) {
    const sample::Scratch scratch;
    Recording recording = record(GetParam(), scratch);
    const std::size_t middle = recording.ticks.size() / 2;
    recording.ticks.erase(recording.ticks.begin() + static_cast<std::ptrdiff_t>(middle));
    const ReplayOutcome outcome = replayed(GetParam(), recording);
    EXPECT_EQ(outcome.different_ticks, 0);
    EXPECT_EQ(outcome.missing_ticks, 1);
    EXPECT_GT(outcome.ticks, GetParam().ticks / 2);
    EXPECT_EQ(outcome.ticks + outcome.skipped_ticks + outcome.missing_ticks, GetParam().ticks);
}

TEST_P(Replay, of_a_changed_input_differs_from_that_tick_on) {
    const sample::Scratch scratch;
    Recording recording = record(GetParam(), scratch);
    // Pressed against something, deep enough that a micrometre is felt.
    const auto pressed = std::ranges::find_if(recording.ticks, [](const Tick& row) {
        return row.force[2] > 0.02 && row.status == tick_ok && row.detected_tick < 0;
    });
    ASSERT_NE(pressed, recording.ticks.end());
    for (double& x : pressed->device_position) x += 1e-3;
    const ReplayOutcome outcome = replayed(GetParam(), recording);
    ASSERT_TRUE(outcome.first_difference.has_value());
    EXPECT_EQ(outcome.first_difference->tick, pressed->tick);
    EXPECT_GT(outcome.largest_difference, 1e-9);
}

TEST_P(Replay, of_a_changed_torque_differs_in_that_tick_alone) {
    const sample::Scratch scratch;
    Recording recording = record(GetParam(), scratch);
    Tick& row = recording.ticks[recording.ticks.size() / 2];
    row.torque[1] += 1e-6;
    const ReplayOutcome outcome = replayed(GetParam(), recording);
    EXPECT_EQ(outcome.different_ticks, 1);
    ASSERT_TRUE(outcome.first_difference.has_value());
    EXPECT_EQ(outcome.first_difference->tick, row.tick);
    EXPECT_EQ(outcome.first_difference->tool, row.tool);
    EXPECT_EQ(outcome.first_difference->recorded_torque, row.torque);
    EXPECT_EQ(outcome.first_difference->recorded, outcome.first_difference->replayed);
    EXPECT_EQ(outcome.largest_difference, 0);
    EXPECT_GT(outcome.largest_torque_difference, 0);
}

// Where tools do not turn, a recording may be older than the column of torques, which reads as zero.
TEST_P(Replay, has_torques_where_the_tool_turns_by_itself_and_none_elsewhere) {
    const sample::Scratch scratch;
    Recording recording = record(GetParam(), scratch);
    constexpr std::array<double, 3> none{0, 0, 0};
    const auto twisted =
        std::ranges::count_if(recording.ticks, [&](const Tick& row) { return row.torque != none; });
    if (GetParam().turns) {
        EXPECT_GT(twisted, GetParam().ticks / 40);
        return;
    }
    EXPECT_EQ(twisted, 0);
    for (Tick& row : recording.ticks) row.torque = none;
    EXPECT_EQ(replayed(GetParam(), recording).different_ticks, 0);
}

Case pointed() {
    Case c = ball_and_cube();
    c.haptics.shaft_length = 0;
    return c;
}
Case creeping() {  // quickly enough to be forgotten between two touches
    Case c = pointed();
    for (const Label& region : c.deformable_bodies[0].mesh.region_names)
        c.deformable_bodies[0].relaxation.push_back({region.value, {0.3, 0.002}});
    return c;
}
Case far() {
    Case c = ball_and_cube();
    c.hyperelastic = {c.deformable_bodies[0].name};
    return c;
}
Case with_rod() {
    Case c = ball_and_cube();
    c.tool = ToolBody{};
    return c;
}
Case with_bar() {
    Case c = ball_and_cube();
    c.rigid_bodies.push_back(rigid("floor", box({-20, -20, 5}, {60, 40, 21})));
    c.tool = ToolBody{.surface = box({-1, -1, 0}, {1, 1, 30}), .settings = {.shell_points = 150, .voxel = 4}};
    return c;
}

// A round tool, whose search has many places to begin at.
Case with_ball() {
    Case c = with_bar();
    c.tool->surface = sample::sphere_surface({0, 0, 0}, 3, 3);
    return c;
}

Case with_instrument() {
    Case c = ball_and_cube();
    c.tool = ToolBody{.surface = box({-2, -2, 0}, {2, 2, 30}), .settings = {}};
    return c;
}

constexpr std::array runs{Trial{"shaft", ball_and_cube, "continuous", 1, 6000},
                          Trial{"two_tools", ball_and_cube, "continuous", 2, 3000},
                          Trial{"tip", pointed, "continuous", 1, 12000},
                          Trial{"creeping", creeping, "continuous", 1, 12000},
                          Trial{"hyperelastic", far, "continuous", 1, 6000},
                          Trial{"single", ball_and_cube, "single", 1, 12000},
                          Trial{"twice", ball_and_cube, "twice", 1, 12000},
                          Trial{"twice_renewed", ball_and_cube, "twice-renewed", 1, 12000},
                          Trial{"turning_rod", with_rod, "continuous", 1, 6000, true},
                          Trial{"two_turning_rods", with_rod, "continuous", 2, 3000, true},
                          Trial{"instrument", with_instrument, "continuous", 1, 6000, true},
                          Trial{"shell", with_bar, "shell", 1, 6000, true},
                          Trial{"cones", with_bar, "cones", 1, 6000, true},
                          Trial{"features", with_bar, "features", 1, 6000, true},
                          Trial{"features_of_a_ball", with_ball, "features", 1, 6000, true}};

INSTANTIATE_TEST_SUITE_P(Runs, Replay, testing::ValuesIn(runs),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(ReplayStart, that_is_not_there_is_told) {
    const sample::Scratch scratch;
    const Trial trial{"start", ball_and_cube, "continuous", 1, 2000};
    Recording recording = record(trial, scratch);
    std::erase_if(recording.ticks, [](const Tick& row) { return row.contact_count == 0; });
    EXPECT_FALSE(replayed(trial, recording).started.has_value());
}

}  // namespace
}  // namespace palpate
