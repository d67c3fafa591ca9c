// SPDX-License-Identifier: Apache-2.0
// What a recording says of the run: the tool that was held, and which tissue was hyperelastic.
#include <array>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "tests/formats/recording/recorded_rows.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace recording;
using sample::refusal;
using sample::Scratch;
using testing::HasSubstr;

// A closed surface of four triangles, and settings none of which is the default.
ToolBody wedge() {
    return {.surface = {.vertices = {{0, 0, 0}, {2, 0, 0.125}, {0, 3, -0.25}, {0.1, 0.2, 40}},
                        .triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}},
            .settings = {.shell_points = 321,
                         .voxel = 0.7,
                         .contact_stiffness = 12,
                         .torsional_stiffness = 333,
                         .max_torque = 111,
                         .max_torque_rate = 22}};
}

void make_recording_of(const std::filesystem::path& path, const ToolBody& tool) {
    RecordingHead head = two_tools();
    head.tool = tool;
    make_recording(path, head, 50);
    RecordingWriter writer(path);
    add_rows(writer, 20, 5);
}

TEST(Recording, holds_the_tool_that_was_held) {
    const Scratch scratch;
    for (const bool rod : {false, true}) {
        ToolBody tool = wedge();
        if (rod) tool.surface = {};
        const auto path = scratch / "run.h5";
        make_recording_of(path, tool);
        const Recording recording = read_recording(path);
        ASSERT_TRUE(recording.head.tool.has_value());
        EXPECT_EQ(recording.head.tool->surface.vertices, tool.surface.vertices);
        EXPECT_EQ(recording.head.tool->surface.triangles, tool.surface.triangles);
        expect_same(recording.head.tool->settings, tool.settings, tool_fields);
        expect_rows(recording, 20, 5);
    }
}

TEST(Recording, of_a_tool_that_none_can_be_is_refused_and_the_dataset_named) {
    const Scratch scratch;
    const auto path = scratch / "run.h5";
    const auto refusal_of = [&](auto spoil) {
        ToolBody tool = wedge();
        spoil(tool);
        make_recording_of(path, tool);
        return refusal([&] { read_recording(path); });
    };
    const double nan = std::nan("");
    EXPECT_THAT(refusal_of([](ToolBody& tool) { tool.surface.triangles[1][2] = 4; }),
                HasSubstr("run.h5: /tool/triangles"));
    EXPECT_THAT(refusal_of([](ToolBody& tool) { tool.surface.triangles[3][0] = -1; }),
                HasSubstr("run.h5: /tool/triangles"));
    EXPECT_THAT(refusal_of([&](ToolBody& tool) { tool.surface.vertices[2].y() = nan; }),
                HasSubstr("run.h5: /tool/vertices: point 2"));
    EXPECT_THAT(refusal_of([](ToolBody& tool) { tool.surface.vertices[0].x() = 1e300; }),
                HasSubstr("run.h5: /tool/vertices: point 0"));
    EXPECT_THAT(refusal_of([](ToolBody& tool) { tool.settings.voxel = 0; }),
                HasSubstr("run.h5: /tool: voxel is 0"));
    EXPECT_THAT(refusal_of([&](ToolBody& tool) { tool.settings.max_torque = nan; }),
                HasSubstr("run.h5: /tool: max_torque is nan"));
    EXPECT_THAT(refusal_of([](ToolBody& tool) { tool.settings.shell_points = 1'000'000'000; }),
                HasSubstr("run.h5: /tool: shell_points is"));
}

TEST(Recording, of_a_tool_of_which_half_is_missing_is_refused_and_the_dataset_named) {
    const Scratch scratch;
    const auto path = scratch / "run.h5";
    for (const char* missing : {"/tool/vertices", "/tool/triangles"}) {
        make_recording_of(path, wedge());
        take_out(path, {missing});
        EXPECT_THAT(refusal([&] { read_recording(path); }), HasSubstr(std::string("run.h5: ") + missing));
    }
}

TEST(Recording, holds_the_jaws_of_a_forceps_and_refuses_those_that_none_can_have) {
    const Scratch scratch;
    const auto path = scratch / "run.h5";
    const JawSettings jaws{
        .jaw_length = 15, .jaw_radius = 1.5, .jaw_opening = 45, .jaw_friction = 0.2, .jaw_grip = 0.03};
    const auto record_of = [&](const JawSettings& held) {
        RecordingHead head = two_tools();
        head.jaws = held;
        make_recording(path, head, 50);
        RecordingWriter writer(path);
        add_rows(writer, 20, 5);
    };
    record_of(jaws);
    const Recording recording = read_recording(path);
    ASSERT_TRUE(recording.head.jaws.has_value());
    expect_same(*recording.head.jaws, jaws, jaw_fields);
    expect_rows(recording, 20, 5);
    JawSettings bent = jaws;
    bent.jaw_opening = 400;
    record_of(bent);
    EXPECT_THAT(refusal([&] { read_recording(path); }), HasSubstr("run.h5: /jaws: jaw_opening is 400"));
}

TEST(Recording, names_the_hyperelastic_bodies_and_refuses_names_that_no_body_has) {
    const Scratch scratch;
    const auto path = scratch / "run.h5";
    const auto record_of = [&](const std::vector<std::string>& names) {
        RecordingHead head = two_tools();
        head.hyperelastic = names;
        make_recording(path, head, 50);
        RecordingWriter writer(path);
        add_rows(writer, 20, 5);
    };
    for (const std::vector<std::string>& names : {std::vector<std::string>{}, {"liver", "gallbladder"}}) {
        record_of(names);
        EXPECT_EQ(read_recording(path).head.hyperelastic, names);
    }
    record_of({"li\nver"});
    EXPECT_THAT(refusal([&] { read_recording(path); }), HasSubstr("run.h5: /hyperelastic"));
}

TEST(Recording, says_how_many_ticks_lie_between_two_rows) {
    const Scratch scratch;
    const auto path = scratch / "run.h5";
    RecordingHead head = two_tools();
    for (const std::int32_t every : {1, 20, longest_every}) {
        head.every = every;
        make_recording(path, head, 50);
        {
            RecordingWriter writer(path);
            add_rows(writer, 20, 5);
        }
        EXPECT_EQ(read_recording(path).head.every, every);
    }
    for (const std::int32_t every : {-1, 0, longest_every + 1}) {
        head.every = every;
        EXPECT_THAT(refusal([&] { make_recording(path, head, 50); }),
                    HasSubstr("one tick of " + std::to_string(every)));
    }
}

TEST(Recording, of_a_tool_without_a_triangle_is_refused) {
    const Scratch scratch;
    const auto path = scratch / "run.h5";
    make_recording_of(path, wedge());
    take_out(path, {"/tool/triangles"});
    edit(path, [](hid_t file) {
        const std::array<hsize_t, 2> none{0, 3};
        const hid_t space = H5Screate_simple(2, none.data(), nullptr);
        H5Dclose(
            H5Dcreate2(file, "/tool/triangles", H5T_STD_I32LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
        H5Sclose(space);
    });
    EXPECT_THAT(refusal([&] { read_recording(path); }), HasSubstr("run.h5: /tool: has no triangle"));
}

}  // namespace
}  // namespace palpate
