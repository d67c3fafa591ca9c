// SPDX-License-Identifier: Apache-2.0
// A recording is shown as it was: every tick for as long as it lasted, with its own forces and contacts.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "runtime/session/playback/playback_clock.hpp"
#include "runtime/session/playback/recorded_surfaces.hpp"
#include "runtime/session/playback/recorded_track.hpp"
#include "runtime/session/playback/run_excerpt.hpp"
#include "runtime/session/replay.hpp"
#include "runtime/session/run_recorder.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace devices;
using namespace haptics;
using namespace recording;
using namespace session;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

using Surfaces = std::vector<std::vector<Vector3f>>;

// So many ticks of tool 0, a millisecond apart, the k-th with a force of k N along x.
Recording counting(std::int64_t ticks) {
    Recording recording;
    recording.head.devices.resize(1);
    for (std::int64_t k = 0; k < ticks; ++k) {
        Tick tick{};
        tick.tick = k;
        tick.time = 1e-3 * static_cast<double>(k + 1);
        tick.force = {static_cast<double>(k), 0, 0};
        recording.ticks.push_back(tick);
    }
    return recording;
}

TEST(RecordedTrack, shows_the_last_tick_by_then_and_holds_it_where_ticks_are_missing) {
    Recording recording = counting(100);
    recording.ticks.erase(recording.ticks.begin() + 40, recording.ticks.begin() + 60);
    const RecordedTrack track = track_of(recording, 0, "run.h5");
    EXPECT_EQ(tick_at(track, -1).tick, 0);
    EXPECT_EQ(tick_at(track, 0.0215).tick, 20);
    EXPECT_EQ(tick_at(track, recording.ticks[20].time).tick, 20);
    EXPECT_EQ(tick_at(track, 0.0555).tick, 39);
    EXPECT_EQ(tick_at(track, std::nextafter(recording.ticks[20].time, 0)).tick, 20);
    EXPECT_EQ(tick_at(track, recording.ticks[40].time).tick, 60);
    EXPECT_EQ(tick_at(track, 1e9).tick, 99);
    EXPECT_EQ(missing_ticks(track), 20);
}

// Tick `number` of a tool, with so many contacts, numbered too.
TickResult touching(std::int64_t number, std::int32_t tool, std::int32_t contacts) {
    TickResult tick{};
    tick.tick = number;
    tick.tool = tool;
    tick.time = 1e-3 * static_cast<double>(number + 1);
    tick.contact_count = contacts;
    for (std::int32_t k = 0; k < contacts; ++k) {
        tick.contacts[static_cast<std::size_t>(k)].triangle = k;
        tick.contacts[static_cast<std::size_t>(k)].force = static_cast<float>(number + tool);
    }
    return tick;
}

TEST(RunExcerpt, comes_back_from_its_file_with_fifty_ticks_a_second_of_every_tool) {
    RunExcerpt excerpt;
    for (std::int64_t number = 1007; number < 1407; ++number)
        for (const std::int32_t tool : {0, 1})
            excerpt.add(touching(number, tool, static_cast<std::int32_t>(number / 20 % 60)));
    Recording kept = excerpt.take();
    EXPECT_TRUE(excerpt.take().ticks.empty());
    kept.head = {.palpate_version = "1",
                 .case_name = "block",
                 .asset_digest = "digest",
                 .scheme = "continuous",
                 .clock = "virtual",
                 .coupling_stiffness = 0.5,
                 .haptics = {},
                 .devices = {{"first", {}}, {"second", {}}},
                 .every = kept.head.every};
    const sample::Scratch scratch;
    write_recording(scratch / "excerpt.h5", kept);
    const Recording read = read_recording(scratch / "excerpt.h5");
    EXPECT_EQ(read.head.every, 20);
    ASSERT_EQ(read.ticks.size(), 40U);
    for (std::size_t row = 0; row < read.ticks.size(); ++row) {
        const Tick& tick = read.ticks[row];
        EXPECT_EQ(tick.tick, 1020 + 20 * static_cast<std::int64_t>(row / 2));
        EXPECT_EQ(tick.tool, static_cast<std::int32_t>(row % 2));
        const auto contacts = read.contacts_of(tick);
        ASSERT_EQ(std::ssize(contacts), tick.tick / 20 % 60);
        for (std::size_t k = 0; k < contacts.size(); ++k) {
            EXPECT_EQ(contacts[k].triangle, static_cast<std::int32_t>(k));
            EXPECT_EQ(contacts[k].force, static_cast<float>(tick.tick + tick.tool));
        }
    }
    EXPECT_EQ(missing_ticks(track_of(read, 1, "excerpt.h5"), read.head.every), 0);
    EXPECT_THROW(require_all_ticks(read, "excerpt.h5"), InvalidInput);
}

TEST(RunExcerpt, that_becomes_long_keeps_fewer_ticks_of_all_of_it) {
    for (const std::int32_t contacts : {0, 64}) {
        RunExcerpt excerpt;
        constexpr std::int64_t last = 40'000;
        for (std::int64_t k = 0; k <= last; ++k) excerpt.add(touching(20 * k, 0, contacts));
        const Recording kept = excerpt.take();
        EXPECT_LE(kept.ticks.size(), RunExcerpt::most_rows);
        EXPECT_LE(kept.contacts.size(), RunExcerpt::most_contacts);
        EXPECT_EQ(kept.head.every, contacts == 0 ? 40 : 320);  // no more than these bounds ask for
        for (std::size_t row = 0; row < kept.ticks.size(); ++row) {
            ASSERT_EQ(kept.ticks[row].tick, static_cast<std::int64_t>(row) * kept.head.every);
            ASSERT_EQ(std::ssize(kept.contacts_of(kept.ticks[row])), contacts);
        }
        EXPECT_GT(kept.ticks.back().tick + kept.head.every, 20 * last);
    }
}

TEST(RecordedTrack, is_of_one_tool_and_refuses_one_without_ticks) {
    Recording recording = counting(10);
    recording.head.devices.resize(3);
    for (std::size_t k = 1; k < 10; k += 2) recording.ticks[k].tool = 2;
    for (const Tick* tick : track_of(recording, 2, "run.h5")) EXPECT_EQ(tick->tool, 2);
    EXPECT_EQ(track_of(recording, 2, "run.h5").size(), 5U);
    EXPECT_THROW(track_of(recording, 1, "run.h5"), InvalidInput);
    EXPECT_THROW(track_of(recording, -1, "run.h5"), InvalidInput);
}

TEST(RecordedTrack, knows_how_fast_the_run_ticked) {
    Recording recording = counting(2000);
    const RecordedTrack track = track_of(recording, 0, "run.h5");
    EXPECT_NEAR(tick_rate_at(track, 1.5), 1000, 1e-6);
    EXPECT_EQ(tick_rate_at(track, 0), 0);
    for (Tick& tick : recording.ticks) tick.time *= 2;
    EXPECT_NEAR(tick_rate_at(track, 1.5), 500, 1e-6);
}

TEST(RecordedTrack, shows_flags_for_two_seconds_and_not_before_they_came) {
    Recording recording = counting(6000);
    recording.ticks[2000].faults = motors_warm;
    recording.ticks[2001].status = contacts_cut;
    const auto at = [&](double time) { return flags_until(recording, time); };
    EXPECT_EQ(at(recording.ticks[1999].time).faults, no_fault);
    EXPECT_EQ(at(recording.ticks[2000].time).faults, motors_warm);
    EXPECT_EQ(at(recording.ticks[2000].time).statuses, tick_ok);
    EXPECT_EQ(at(3.5).faults, motors_warm);
    EXPECT_EQ(at(3.5).statuses, contacts_cut);
    EXPECT_EQ(at(4.5).faults, no_fault);
    EXPECT_EQ(at(4.5).statuses, tick_ok);
}

TEST(RecordedTrack, gives_least_and_largest_force_of_every_column) {
    Recording recording = counting(1000);
    recording.ticks[444].force = {0, 0, 2e6};  // a peak of one tick
    const RecordedTrack track = track_of(recording, 0, "run.h5");
    for (const std::size_t count : {1, 7, 10, 640}) {
        const auto columns = force_columns(track, count);
        ASSERT_EQ(columns.size(), count);
        double most = 0, least = 1e9;
        for (const Vector2d& column : columns) {
            EXPECT_LE(column[0], column[1]);
            most = std::max(most, column[1]);
            least = std::min(least, column[0]);
        }
        EXPECT_EQ(most, 2e6);
        EXPECT_EQ(least, 0);
        EXPECT_GE(columns.back()[1], 999);  // the last tick is in the last column
    }
    const auto columns = force_columns(track, 10);
    EXPECT_NEAR(columns[2][0], 200, 1);
    EXPECT_NEAR(columns[2][1], 299, 1);
    EXPECT_EQ(columns[4][1], 2e6);
}

TEST(RecordedTrack, holds_the_force_over_columns_without_a_tick) {
    Recording recording = counting(100);
    recording.ticks.erase(recording.ticks.begin() + 30, recording.ticks.begin() + 70);
    const auto columns = force_columns(track_of(recording, 0, "run.h5"), 10);
    for (const std::size_t column : {4, 5, 6}) EXPECT_EQ(columns[column], Vector2d(29, 29)) << column;
    recording.ticks.resize(1);
    for (const Vector2d& column : force_columns(track_of(recording, 0, "run.h5"), 5))
        EXPECT_EQ(column, Vector2d(0, 0));
}

TEST(Demonstration, begins_a_second_before_the_first_contact_and_ends_a_second_after_the_last) {
    Recording recording = counting(10'000);
    for (std::size_t k = 3000; k < 5000; ++k) recording.ticks[k].contact_count = 1;
    const RecordedTrack track = track_of(recording, 0, "run.h5");
    const Demonstration shown = demonstration_of(track);
    EXPECT_NEAR(shown.begins, 2.001, 1e-9);
    EXPECT_NEAR(shown.ends, 6, 1e-9);
    EXPECT_NEAR(shown.around(0.5), 2.501, 1e-9);
    EXPECT_NEAR(shown.around(0.5 + 2 * (shown.ends - shown.begins)), 2.501, 1e-9);
    recording.ticks[0].contact_count = recording.ticks[9999].contact_count = 1;
    EXPECT_EQ(demonstration_of(track).begins, track.front()->time);
    EXPECT_EQ(demonstration_of(track).ends, track.back()->time);
}

TEST(Demonstration, that_touches_nothing_is_the_whole_recording) {
    Recording recording = counting(10);
    const RecordedTrack track = track_of(recording, 0, "run.h5");
    EXPECT_EQ(demonstration_of(track).begins, track.front()->time);
    EXPECT_EQ(demonstration_of(track).ends, track.back()->time);
    recording.ticks.resize(1);
    const RecordedTrack moment = track_of(recording, 0, "run.h5");
    EXPECT_EQ(demonstration_of(moment).around(5), moment.front()->time);
}

TEST(PlaybackClock, goes_on_at_its_speed_and_stands_still_at_the_end) {
    PlaybackClock clock(10, 20, 1);
    EXPECT_EQ(clock.time(), 10);
    clock.advance(2);
    EXPECT_EQ(clock.time(), 12);
    clock.press("period");
    clock.advance(1);
    EXPECT_EQ(clock.time(), 14);
    EXPECT_DOUBLE_EQ(clock.share(), 0.4);
    for (int i = 0; i < 10; ++i) clock.press("period");
    EXPECT_EQ(clock.speed(), 4);
    for (int i = 0; i < 10; ++i) clock.press("comma");
    EXPECT_EQ(clock.speed(), 0.125);
    clock.advance(1000);
    EXPECT_EQ(clock.time(), 20);
    EXPECT_FALSE(clock.runs());
    clock.press("space");  // from the beginning
    EXPECT_EQ(clock.time(), 10);
    EXPECT_TRUE(clock.runs());
}

TEST(PlaybackClock, stops_steps_and_jumps_within_its_ends) {
    PlaybackClock clock(0, 1, 1);
    clock.press("space");
    clock.advance(0.5);
    EXPECT_EQ(clock.time(), 0);
    clock.press("right");
    EXPECT_DOUBLE_EQ(clock.time(), 0.1);
    clock.press("comma");
    clock.press("right");
    EXPECT_DOUBLE_EQ(clock.time(), 0.15);
    clock.press("left");
    clock.press("left");
    clock.press("left");
    clock.press("left");
    EXPECT_EQ(clock.time(), 0);
    clock.seek_share(0.75);
    EXPECT_DOUBLE_EQ(clock.time(), 0.75);
    clock.seek(7);
    EXPECT_EQ(clock.time(), 1);
    clock.seek_share(-1);
    EXPECT_EQ(clock.time(), 0);
    clock.press("space");
    clock.press("right");  // a step stops it
    EXPECT_FALSE(clock.runs());
    clock.press("end");
    EXPECT_EQ(clock.time(), 1);
    clock.press("home");
    EXPECT_EQ(clock.time(), 0);
    PlaybackClock moment(3, 3, 1);
    EXPECT_EQ(moment.share(), 0);
}

// Two tools that press on the elastic cube and leave it, recorded.
struct PressedCube {
    explicit PressedCube(double relaxation_share = 0) : patient_case(soft_cube(4)) {
        DeformableBody& body = patient_case.deformable_bodies[0];
        if (relaxation_share > 0)
            for (const Label& region : body.mesh.region_names)
                body.relaxation.push_back({region.value, {relaxation_share, 0.4}});
        model.emplace(patient_case, usual_contact_method, 2);
        const auto hand = [](double x) {
            return SimulatedDevice(HandPath({{0, {x, 10, 23}},
                                             {0.3, {x, 10, 18}},
                                             {0.6, {x, 10, 18}},
                                             {0.9, {x, 10, 24}},
                                             {1.8, {x, 10, 24}}}),
                                   {});
        };
        SimulatedDevice one = hand(6), other = hand(14);
        const std::vector<realtime::Device*> held{&one, &other};
        ServoLoop loop(*model, held);
        RecordingHead head{.palpate_version = "0",
                           .case_name = patient_case.name,
                           .asset_digest = "0",
                           .scheme = std::string(usual_contact_method),
                           .clock = "virtual",
                           .coupling_stiffness = model->coupling(),
                           .haptics = patient_case.haptics,
                           .devices = {{"one", {}}, {"two", {}}}};
        const sample::Scratch scratch;
        make_recording(scratch / "run.h5", head, 4001);
        RunRecorder recorder(scratch / "run.h5");
        loop.run_virtual(2000, [&](const TickResult& result) { recorder.add(result); });
        recording = read_recording(scratch / "run.h5");
    }

    Surfaces nothing() const {
        return {
            std::vector<Vector3f>(patient_case.deformable_bodies[0].boundary.nodes.size(), Vector3f::Zero())};
    }

    Case patient_case;
    std::optional<HapticModel> model;
    Recording recording;
};

double largest(const Surfaces& surfaces) {
    double most = 0;
    for (const Vector3f& u : surfaces[0]) most = std::max(most, static_cast<double>(u.norm()));
    return most;
}

double difference(const Surfaces& a, const Surfaces& b) {
    Surfaces c = a;
    for (std::size_t v = 0; v < c[0].size(); ++v) c[0][v] -= b[0][v];
    return largest(c);
}

TEST(RecordedSurfaces, are_what_the_recorded_contacts_of_all_tools_make) {
    const PressedCube run;
    RecordedSurfaces surfaces(run.recording, *run.model, run.patient_case);
    Surfaces shown = run.nothing(), expected = run.nothing(), of_one = run.nothing();
    double most = 0;
    for (const double time : {0.1, 0.35, 0.5, 0.7, 0.4, 1.7}) {
        surfaces.at(time, shown);
        expected = run.nothing();
        for (const Tick& row : run.recording.ticks) {
            if (std::abs(row.time - time) > 1e-6) continue;
            run.model->surface_displacement(0, with_contacts(run.recording, row), of_one[0]);
            for (std::size_t v = 0; v < of_one[0].size(); ++v) expected[0][v] += of_one[0][v];
        }
        EXPECT_LT(difference(shown, expected), 1e-6) << time;  // float's rounding of 3 mm
        most = std::max(most, largest(shown));
    }
    EXPECT_GT(most, 0.5);
    EXPECT_EQ(largest(shown), 0);
}

TEST(RecordedSurfaces, keep_the_dent_that_creep_leaves_wherever_one_jumps_to) {
    const PressedCube run(0.4);
    ASSERT_GT(run.model->memory_ticks(), 0);
    RecordedSurfaces played(run.recording, *run.model, run.patient_case),
        jumped(run.recording, *run.model, run.patient_case);
    Surfaces one = run.nothing(), other = run.nothing();
    for (double time = 0.001; time < 0.95; time += 0.02) played.at(time, one);
    jumped.at(1.9, other);
    jumped.at(0.941, other);
    const double dent = largest(one);
    EXPECT_GT(dent, 0.1);                           // nothing touches any more
    EXPECT_LT(difference(one, other), 0.1 * dent);  // steps of another length
    jumped.at(0.1, other);
    EXPECT_EQ(largest(other), 0);
    jumped.at(0.941, other);
    EXPECT_LT(difference(one, other), 0.1 * dent);
}

TEST(RecordedContacts, that_the_case_cannot_have_are_refused) {
    const PressedCube run;
    check_contacts(run.recording, run.patient_case, "run.h5");
    ASSERT_FALSE(run.recording.contacts.empty());
    const auto refused = [&](auto change) {
        Recording damaged = run.recording;
        change(damaged.contacts[damaged.contacts.size() / 2]);
        EXPECT_THROW(check_contacts(damaged, run.patient_case, "run.h5"), InvalidInput);
    };
    refused([](Contact& contact) { contact.body = 1; });
    refused([](Contact& contact) { contact.body = -1; });
    refused([](Contact& contact) { contact.vertices[1] = 100'000; });
    refused([](Contact& contact) { contact.vertices[0] = -2; });
    refused([](Contact& contact) { contact.other_body = 0, contact.other_vertex = -1; });
    refused([](Contact& contact) { contact.other_body = 7, contact.other_vertex = 0; });
    refused([](Contact& contact) { contact.force = std::numeric_limits<float>::quiet_NaN(); });
    refused([](Contact& contact) { contact.normal[2] = std::numeric_limits<float>::infinity(); });
}

TEST(RecordedContacts, that_were_overwritten_are_none) {
    const PressedCube run;
    const auto pressed =
        std::ranges::find_if(run.recording.ticks, [](const Tick& t) { return t.contact_count > 0; });
    ASSERT_NE(pressed, run.recording.ticks.end());
    EXPECT_EQ(with_contacts(run.recording, *pressed).contact_count, pressed->contact_count);
    Recording late = run.recording;
    late.contacts_before += 1'000'000;
    EXPECT_EQ(with_contacts(late, *pressed).contact_count, 0);
    EXPECT_EQ(with_contacts(late, *pressed).force, pressed->force);
}

}  // namespace
}  // namespace palpate
