// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <gtest/gtest.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "formats/asset/asset.hpp"
#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "formats/recording/recording_writer.hpp"
#include "runtime/devices/simulation.hpp"
#include "runtime/session/device_list.hpp"
#include "runtime/session/replay.hpp"
#include "runtime/session/session.hpp"
#include "runtime/session/touch_target.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/runtime/elastic_cube.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace devices;
using namespace recording;
using namespace session;

constexpr double turning_error = 1e-7;  // rad: angularDistance() is no better near zero

std::filesystem::path sample_asset(const sample::Scratch& scratch) {
    Case patient_case = sample::sample_case();
    patient_case.deformable_bodies = {sample::true_elastic_cube(3)};
    const auto path = scratch / "sample.vtkhdf";
    asset::write_asset(path, patient_case);
    return path;
}

// Presses on the cube, with a device in a hand that gives way.
void hold_a_press(Session& session) {
    const TouchPoint place = choose_touch_target(session.patient_case(), session.model(), "", {}).place;
    const HandPath path = press_path(place, {.tool_radius = session.model().contact_radius(), .seconds = 2});
    session.hold(
        choose_device("touch").open({.tools = {scripted_tool(path, place.normal, {0, 0, 0})}, .limits = {}}));
}

// A press by a tool that all but lies on the surface, and turns about its shaft meanwhile.
HandPath turning_press(const Session& session) {
    const TouchPoint place = choose_touch_target(session.patient_case(), session.model(), "", {}).place;
    const HandPath press = press_path(place, {.tool_radius = session.model().contact_radius(), .seconds = 2});
    std::vector<HandPath::Key> keys(press.keys().begin(), press.keys().end());
    const Eigen::Vector3d shaft = (0.1 * place.normal + place.tangent).normalized();
    for (HandPath::Key& key : keys)
        key.orientation = Eigen::AngleAxisd(key.time, shaft) *
                          Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), shaft);
    return HandPath(std::move(keys));
}

void record(Session& session, const std::filesystem::path& file) {
    make_recording(file, session.recording_head("0"), 4000);
    session.record_to(file);
}

TEST(Session, ticks_records_and_counts_in_virtual_time_and_replays_bit_for_bit) {
    for (const haptics::ContactMethodEntry& method : haptics::contact_methods()) {
        const sample::Scratch scratch;
        const auto asset = sample_asset(scratch), file = scratch / "run.h5";
        std::int64_t felt = 0, seen = 0;
        {
            Session session({.asset = asset, .method = std::string(method.name), .virtual_clock = true});
            hold_a_press(session);
            record(session, file);
            session.run_virtual(2, [&](const TickResult& result) {
                EXPECT_EQ(result.tick, seen++);
                felt += vector_of(result.force).norm() > 0;
            });
            EXPECT_EQ(session.statistics().ticks, 2000);
            EXPECT_EQ(session.statistics().lost_records, 0);
            EXPECT_EQ(session.recorded_rows(), 2000);
            EXPECT_TRUE(session.faults_json().empty());
            EXPECT_EQ(session.device_name(), "simulated touch, scripted hand");
        }
        EXPECT_EQ(seen, 2000);
        EXPECT_GT(felt, 100) << method.name;
        const Recording recording = read_recording(file);
        EXPECT_EQ(recording.head.clock, "virtual");
        EXPECT_EQ(recording.head.scheme, method.name);
        const Case patient_case = recorded_case(recording, file, asset);
        const auto model = model_of(recording, file, patient_case);
        const ReplayOutcome outcome = replay(recording, *model, [](const TickResult&) {});
        EXPECT_EQ(outcome.ticks, 2000);
        EXPECT_EQ(outcome.different_ticks, 0) << method.name;
    }
}

// What is held, and by which method it is felt.
struct HeldBody {
    const char* method;
    ToolBody tool;
};

TEST(Session, a_tool_that_turns_is_as_its_hand_wishes_and_its_recording_alone_replays_bit_for_bit) {
    const HeldBody bar{"shell", {.surface = box({-1, -1, 0}, {1, 1, 40}), .settings = {.shell_points = 500}}};
    const HeldBody rod{"continuous", {}};
    for (const auto& [method, tool] : {bar, rod}) {
        const sample::Scratch scratch;
        Case sample = sample::sample_case();
        sample.deformable_bodies = {sample::true_elastic_cube(3)};
        sample.haptics.shaft_length = 15;
        const auto asset = scratch / "sample.vtkhdf", file = scratch / "run.h5";
        asset::write_asset(asset, sample);
        std::int64_t twisted = 0;
        {
            Session session({.asset = asset, .method = method, .virtual_clock = true, .tool = tool});
            const HandPath path = turning_press(session);
            session.hold(choose_device("touch").open(
                {.tools = {scripted_tool(path, {0, 0, 1}, {0, 0, 0})}, .limits = {}}));
            record(session, file);
            session.run_virtual(2, [&](const TickResult& result) {
                // The device stands turned in the patient, and its hand's way with it.
                const Eigen::Quaterniond wish = path.orientation_at(result.time);
                EXPECT_LT(wish.angularDistance(quaternion_of(result.orientation)), turning_error);
                twisted += vector_of(result.torque).norm() > 0.01;  // N mm: the wall is soft
            });
        }
        EXPECT_GT(twisted, 100) << method;
        const Recording recording = read_recording(file);
        ASSERT_TRUE(recording.head.tool.has_value());
        EXPECT_EQ(recording.head.tool->surface.vertices, tool.surface.vertices);
        Case patient_case = recorded_case(recording, file, asset);
        const auto model = model_of(recording, file, patient_case);
        const ReplayOutcome outcome = replay(recording, *model, [](const TickResult&) {});
        EXPECT_EQ(outcome.ticks, 2000);
        EXPECT_EQ(outcome.different_ticks, 0) << method;
        // It is the tool that makes the difference.
        patient_case.tool.reset();
        const auto without = model_of(recording, file, patient_case);
        EXPECT_GT(replay(recording, *without, [](const TickResult&) {}).different_ticks, 100) << method;
    }
}

TEST(Session, hands_out_every_tick_of_the_real_clock_once_and_in_order) {
    const sample::Scratch scratch;
    Session session({.asset = sample_asset(scratch)});
    hold_a_press(session);
    record(session, scratch / "run.h5");
    std::int64_t next = 0;
    const Session::Sink in_order = [&](const TickResult& result) { EXPECT_EQ(result.tick, next++); };
    session.start();
    while (next < 200) {
        session.pump(in_order);
        EXPECT_GE(session.latest().tick + 1, next);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    session.stop();
    session.pump(in_order);
    EXPECT_EQ(session.statistics().ticks, next);
    EXPECT_EQ(session.statistics().lost_records, 0);
    EXPECT_EQ(session.recorded_rows(), next);
    EXPECT_EQ(read_recording(scratch / "run.h5").head.clock, "real");
}

TEST(Session, with_large_deformation_replays_what_it_felt_beside_the_real_clock) {
    const sample::Scratch scratch;
    const auto asset = sample_asset(scratch), file = scratch / "run.h5";
    std::int64_t ticks = 0, felt = 0, answers = 0;
    {
        Session session({.asset = asset, .hyperelastic = {"all"}});
        hold_a_press(session);
        record(session, file);
        session.start();
        while (ticks < 1500) {
            session.pump([&](const TickResult& result) {
                ++ticks;
                felt += vector_of(result.force).norm() > 0;
                answers += result.detected_tick >= 0;
            });
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
    }
    EXPECT_GT(felt, 100);
    EXPECT_GT(answers, 10);
    const Recording recording = read_recording(file);
    EXPECT_EQ(recording.head.hyperelastic.size(), 1U);
    const Case patient_case = recorded_case(recording, file, asset);
    const auto model = model_of(recording, file, patient_case);
    EXPECT_EQ(replay(recording, *model, [](const TickResult&) {}).different_ticks, 0);
}

TEST(Session, tells_of_a_fault_once) {
    const sample::Scratch scratch;
    const auto asset = sample_asset(scratch);
    std::vector<std::string> told;
    Session session({.asset = asset}, [&](const std::string& sentence) { told.push_back(sentence); });
    hold_a_press(session);
    std::filesystem::remove(asset);
    std::int64_t faulty = 0;
    session.start();
    for (int wait = 0; wait < 3000 && faulty < 100; ++wait) {
        session.pump([&](const TickResult& result) { faulty += (result.faults & asset_removed) != 0; });
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    EXPECT_TRUE(session.recent_faults(session.latest().time) & asset_removed);
    session.stop();
    EXPECT_GE(faulty, 100);
    const auto of_asset = [](const auto& text) { return text.find("asset_removed") != std::string::npos; };
    EXPECT_EQ(std::ranges::count_if(told, of_asset), 1);
}

// A driver whose scheduler does not start.
class DeadServo final : public realtime::Servo {
  public:
    void start(OnTick) override { throw SystemFailure({"servo", "does not start", "", ""}); }
    void stop() override {}
};

TEST(Session, a_servo_that_does_not_start_leaves_no_empty_recording) {
    const sample::Scratch scratch;
    DeadServo servo;
    Session session({.asset = sample_asset(scratch)});
    OpenDevices devices = choose_device("").open(
        {.tools = {scripted_tool(HandPath({{0, {0, 0, 50}}}), {0, 0, 1}, {0, 0, 0})}, .limits = {}});
    devices.servo = &servo;
    session.hold(std::move(devices));
    record(session, scratch / "run.h5");
    EXPECT_THROW(session.start(), SystemFailure);
    EXPECT_FALSE(std::filesystem::exists(scratch / "run.h5"));
}

TEST(Session, guides_the_hand_that_nothing_else_moves) {
    const sample::Scratch scratch;
    Session session({.asset = sample_asset(scratch), .virtual_clock = true});
    const Eigen::Vector3d start{0, 0, 60}, there{1, 2, 62};
    session.hold(choose_device("").open({.tools = {{.place = DevicePlace{.start = start}}}, .limits = {}}));
    session.guide(there, {0, 0, 0, 0});
    TickResult last{};
    session.run_virtual(0.5, [&](const TickResult& result) { last = result; });
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(last.device_position[axis], there[axis], 1e-9);
}

TEST(Session, takes_as_many_devices_as_it_has_tools) {
    const sample::Scratch scratch;
    Session session({.asset = sample_asset(scratch), .tool_count = 2, .virtual_clock = true});
    EXPECT_THROW(hold_a_press(session), InvalidInput);
}

}  // namespace
}  // namespace palpate
