// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "runtime/devices/hand_path.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace devices;
using Eigen::Vector3d;

std::filesystem::path text_file(const std::string& text) {
    static const sample::Scratch folder;  // of this process: tests run side by side
    const auto path = folder / "palpate_hand_path.txt";
    std::ofstream(path) << text;
    return path;
}

std::string path_refusal(const std::string& text) {
    try {
        read_hand_path(text_file(text));
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "";
}

TEST(HandPath, goes_straight_between_keys_and_rests_outside_them) {
    const HandPath path({{1, {0, 0, 0}}, {2, {2, 4, 6}}, {4, {2, 4, 7}}});
    EXPECT_EQ(path.at(0), Vector3d(0, 0, 0));
    EXPECT_EQ(path.at(1.5), Vector3d(1, 2, 3));
    EXPECT_EQ(path.at(3), Vector3d(2, 4, 6.5));
    EXPECT_EQ(path.at(9), Vector3d(2, 4, 7));
    EXPECT_EQ(path.duration(), 4);
}

TEST(HandPath, refuses_no_keys_times_that_do_not_rise_and_numbers_that_are_none) {
    EXPECT_THROW(HandPath({}), InvalidInput);
    EXPECT_THROW(HandPath({{0, {0, 0, 0}}, {0, {1, 1, 1}}}), InvalidInput);
    EXPECT_THROW(HandPath({{0, {0, std::nan(""), 0}}}), InvalidInput);
}

TEST(HandPath, holds_from_one_key_to_the_next_as_that_key_says) {
    const HandPath path({{1, {0, 0, 0}, false}, {2, {1, 0, 0}}, {3, {1, 0, 0}, false}});
    EXPECT_FALSE(path.holds_at(0));
    EXPECT_FALSE(path.holds_at(1.9));
    EXPECT_TRUE(path.holds_at(2));
    EXPECT_TRUE(path.holds_at(2.999));
    EXPECT_FALSE(path.holds_at(9));
    EXPECT_TRUE(HandPath({{0, {0, 0, 0}}}).holds_at(0));
}

TEST(HandPath, seen_from_another_frame_and_back_is_the_same) {
    const HandPath path({{0, {1, 2, 3}}, {1, {4, 5, 6}, false}, {2, {7, -8, 9}}});
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.rotate(Eigen::AngleAxisd(1.1, Vector3d(1, 2, 3).normalized())).pretranslate(Vector3d(50, 0, -20));
    const HandPath there = mapped_path(path, X), back = mapped_path(there, X.inverse());
    for (const double t : {0.0, 0.3, 1.0, 1.7, 2.0}) {
        EXPECT_LT((there.at(t) - X * path.at(t)).norm(), 1e-12);
        EXPECT_LT((back.at(t) - path.at(t)).norm(), 1e-12);
        EXPECT_EQ(there.holds_at(t), path.holds_at(t));
    }
}

TEST(ReadHandPath, takes_a_position_per_tick_or_times) {
    const HandPath rows = read_hand_path(text_file("# mm\n1 2 3\n\n1, 2, 5 # second\n"));
    EXPECT_EQ(rows.at(0), Vector3d(1, 2, 3));
    EXPECT_EQ(rows.at(0.001), Vector3d(1, 2, 3));
    EXPECT_EQ(rows.at(0.0015), Vector3d(1, 2, 4));
    EXPECT_EQ(rows.at(0.002), Vector3d(1, 2, 5));
    EXPECT_EQ(rows.duration(), 0.002);
    const HandPath timed = read_hand_path(text_file("0 1 2 3\n2,1,2,5\n"));
    EXPECT_EQ(timed.at(1), Vector3d(1, 2, 4));
}

TEST(ReadHandPath, names_file_and_line_of_what_is_wrong) {
    EXPECT_NE(path_refusal("1 2 3\n1 x 3\n").find("palpate_hand_path.txt, line 2"), std::string::npos);
    EXPECT_NE(path_refusal("1 2 3\n1 2 3 4\n").find("line 2: 4 numbers"), std::string::npos);
    EXPECT_NE(path_refusal("1 2\n").find("line 1: 2 numbers"), std::string::npos);
    EXPECT_NE(path_refusal("0 1 2 3\n0 1 2 3\n").find("line 2: time"), std::string::npos);
    EXPECT_NE(path_refusal("1 2 nan\n").find("line 1"), std::string::npos);
    EXPECT_NE(path_refusal("# nothing\n").find("no positions"), std::string::npos);
    EXPECT_THROW(read_hand_path("/nowhere/path.txt"), InvalidInput);
}

TEST(ReadColumn, takes_one_of_a_recording_whatever_stands_in_its_comments) {
    const auto file = text_file("%time, angle [counts]\n0.000,0.5,7\n0.001 1.5 8 % noise\n\n# end\n");
    EXPECT_EQ(read_column(file, 2), (std::vector<double>{0.5, 1.5}));
    EXPECT_EQ(read_column(file, 3), (std::vector<double>{7, 8}));
}

TEST(ReadColumn, names_file_and_line_of_what_is_wrong) {
    const auto refusal_of = [](const std::string& text, std::size_t column) -> std::string {
        try {
            read_column(text_file(text), column);
        } catch (const InvalidInput& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(refusal_of("1 2\n1 2\n", 3).find("line 1: no column 3 (expected 1 to 2)"), std::string::npos);
    EXPECT_NE(refusal_of("1 2\n", 0).find("no column 0"), std::string::npos);
    EXPECT_NE(refusal_of("1 2\n1\n", 2).find("line 2: no column 2"), std::string::npos);
    EXPECT_NE(refusal_of("1 2\n1 two\n", 1).find("line 2"), std::string::npos);
    EXPECT_NE(refusal_of("% nothing\n", 1).find("no rows"), std::string::npos);
}

TEST(SimulatedDevice, refuses_a_hand_that_lets_go) {
    EXPECT_THROW(SimulatedDevice(HandPath({{0, {0, 0, 0}}, {1, {0, 0, 0}, false}}), {}), UsageError);
}

TEST(SimulatedDevice, is_where_its_path_says) {
    SimulatedDevice device(HandPath({{0, {0, 0, 0}}, {1, {1, 2, 3}}}),
                           {.max_force = 3, .max_stiffness = 0.5});
    const realtime::DeviceState state = device.read(0.5);
    EXPECT_EQ(state.position, (std::array<double, 3>{0.5, 1, 1.5}));
    EXPECT_EQ(state.faults, no_fault);
    EXPECT_EQ(device.limits().max_force, 3);
}

}  // namespace
}  // namespace palpate
