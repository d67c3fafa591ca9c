// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/devices/hand_path.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace devices;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double turning_error = 1e-12;  // rad, of a few operations on unit quaternions
constexpr double written_error = 1e-5;   // rad, of a quaternion written with six digits

Quaterniond turn_by(const Vector3d& axis, double degrees) {
    return Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()));
}

// The angle between two orientations, rad; q and -q are the same one.
double angle_between(const Quaterniond& a, const Quaterniond& b) {
    return 2 * std::atan2((a * b.conjugate()).vec().norm(), std::abs((a * b.conjugate()).w()));
}

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

TEST(HandPath, turns_at_a_constant_rate_between_keys_and_rests_outside_them) {
    const Vector3d axis(1, -2, 2);
    const Quaterniond first = turn_by({3, 1, 0}, 40), second = turn_by(axis, 90) * first;
    const HandPath path({{1, {0, 0, 0}, true, first}, {3, {0, 0, 6}, true, second}});
    for (const double t : {-1.0, 0.0, 1.0})
        EXPECT_LT(angle_between(path.orientation_at(t), first), turning_error);
    for (const double t : {3.0, 9.0}) EXPECT_LT(angle_between(path.orientation_at(t), second), turning_error);
    for (const double part : {0.125, 0.25, 0.5, 0.9}) {
        const Quaterniond between = path.orientation_at(1 + 2 * part);
        EXPECT_LT(angle_between(between, turn_by(axis, 90 * part) * first), turning_error) << part;
        EXPECT_NEAR(between.norm(), 1, turning_error);
    }
}

TEST(HandPath, takes_the_shorter_way_whichever_sign_its_quaternions_have) {
    const Quaterniond first = turn_by({1, 2, 0}, 30), second = turn_by(Vector3d::UnitY(), 80) * first;
    const Quaterniond other_sign(-second.coeffs());
    const HandPath path({{0, {0, 0, 0}, true, first}, {1, {0, 0, 0}, true, other_sign}});
    const HandPath same({{0, {0, 0, 0}, true, first}, {1, {0, 0, 0}, true, Quaterniond(-first.coeffs())}});
    for (const double t : {0.0, 0.1, 0.5, 0.75, 1.0}) {
        EXPECT_LT(angle_between(path.orientation_at(t), turn_by(Vector3d::UnitY(), 80 * t) * first),
                  turning_error)
            << t;
        EXPECT_LT(angle_between(same.orientation_at(t), first), turning_error) << t;
    }
}

TEST(HandPath, has_no_orientation_where_its_keys_have_none) {
    const HandPath path({{0, {0, 0, 0}}, {1, {1, 1, 1}}});
    for (const double t : {-1.0, 0.5, 2.0}) EXPECT_TRUE(path.orientation_at(t).coeffs().isZero(0));
}

TEST(HandPath, refuses_orientations_at_some_keys_alone_and_quaternions_that_turn_nothing) {
    const Quaterniond sound = turn_by({1, 1, 1}, 50), none(0, 0, 0, 0), nan(std::nan(""), 0, 0, 1);
    const auto path_of = [](const Quaterniond& first, const Quaterniond& second) {
        return HandPath({{0, {0, 0, 0}, true, first}, {1, {0, 0, 0}, true, second}});
    };
    EXPECT_NO_THROW(path_of(sound, sound));
    EXPECT_THROW(path_of(sound, none), InvalidInput);
    EXPECT_THROW(path_of(none, sound), InvalidInput);
    EXPECT_THROW(path_of(sound, nan), InvalidInput);
    EXPECT_THROW(path_of(sound, Quaterniond(1.001 * sound.coeffs())), InvalidInput);
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

TEST(HandPath, seen_from_another_frame_the_tool_is_turned_with_it) {
    const HandPath path(
        {{0, {1, 2, 3}, true, turn_by({0, 1, 3}, 100)}, {1, {4, 5, 6}, true, turn_by({1, 0, -1}, 20)}});
    const Quaterniond R = turn_by({1, 2, 3}, 63);
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.rotate(R).pretranslate(Vector3d(50, 0, -20));
    const HandPath there = mapped_path(path, X), back = mapped_path(there, X.inverse());
    for (const double t : {0.0, 0.4, 1.0}) {
        // A point of the shaft is where X takes it.
        const Vector3d held = path.at(t) + path.orientation_at(t) * Vector3d(0, 0, 10);
        EXPECT_LT((there.at(t) + there.orientation_at(t) * Vector3d(0, 0, 10) - X * held).norm(), 1e-12);
        EXPECT_LT(angle_between(there.orientation_at(t), R * path.orientation_at(t)), turning_error);
        EXPECT_LT(angle_between(back.orientation_at(t), path.orientation_at(t)), turning_error);
    }
    const HandPath unturned = mapped_path(HandPath({{0, {1, 2, 3}}}), X);
    EXPECT_TRUE(unturned.orientation_at(0).coeffs().isZero(0));
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

// By hand: a quarter turn about x has the quaternion (sin 45, 0, 0, cos 45), x, y, z, w.
TEST(ReadHandPath, takes_a_quaternion_behind_a_position_or_behind_a_time_and_a_position) {
    const HandPath rows = read_hand_path(text_file("1 2 3 0 0 0 1\n1,2,5,0.707107,0,0,0.707107 # turned\n"));
    EXPECT_EQ(rows.at(0.0015), Vector3d(1, 2, 4));
    EXPECT_EQ(rows.duration(), 0.002);
    EXPECT_LT(angle_between(rows.orientation_at(0.001), Quaterniond::Identity()), written_error);
    EXPECT_LT(angle_between(rows.orientation_at(0.0015), turn_by(Vector3d::UnitX(), 45)), written_error);
    EXPECT_LT(angle_between(rows.orientation_at(0.002), turn_by(Vector3d::UnitX(), 90)), written_error);
    // The same way told twice as long, the second quaternion with the other sign.
    const HandPath timed = read_hand_path(text_file("0 1 2 3 0 0 0 1\n2 1 2 5 -0.707107 0 0 -0.707107\n"));
    EXPECT_EQ(timed.at(1), Vector3d(1, 2, 4));
    EXPECT_LT(angle_between(timed.orientation_at(1), turn_by(Vector3d::UnitX(), 45)), written_error);
    EXPECT_LT(angle_between(timed.orientation_at(5), turn_by(Vector3d::UnitX(), 90)), written_error);
    EXPECT_TRUE(read_hand_path(text_file("0 1 2 3\n1 1 2 3\n")).orientation_at(0.5).coeffs().isZero(0));
}

TEST(ReadHandPath, takes_the_angle_of_a_forceps_in_degrees_behind_a_quaternion) {
    const HandPath path = read_hand_path(text_file("0 1 2 3 0 0 0 1 60\n2 1 2 5 0 0 0 1 0\n"));
    EXPECT_EQ(path.at(1), Vector3d(1, 2, 4));
    EXPECT_NEAR(path.jaw_angle_at(0), std::numbers::pi / 3, 1e-12);
    EXPECT_NEAR(path.jaw_angle_at(1), std::numbers::pi / 6, 1e-12);
    EXPECT_EQ(path.jaw_angle_at(3), 0);
    EXPECT_LT(read_hand_path(text_file("0 1 2 3 0 0 0 1\n")).jaw_angle_at(0), 0);
    for (const char* angle : {"-1", "181"})
        EXPECT_NE(path_refusal("0 1 2 3 0 0 0 1 60\n1 1 2 3 0 0 0 1 " + std::string(angle) + "\n")
                      .find("line 2: a jaw angle of"),
                  std::string::npos);
}

TEST(ReadHandPath, takes_quaternions_as_long_as_one_to_a_thousandth_and_names_the_line_of_others) {
    EXPECT_NEAR(read_hand_path(text_file("1 2 3 0 0 0.9991 0\n")).orientation_at(0).norm(), 1, turning_error);
    EXPECT_NEAR(read_hand_path(text_file("1 2 3 0 0 0 1.0009\n")).orientation_at(0).norm(), 1, turning_error);
    for (const char* wrong : {"0 0 0 1.0011", "0 0.9989 0 0", "0 0 0 0", "1 0 0 1"}) {
        EXPECT_NE(path_refusal("1 2 3 0 0 0 1\n1 2 3 " + std::string(wrong) + "\n")
                      .find("palpate_hand_path.txt, line 2: a quaternion of length"),
                  std::string::npos)
            << wrong;
    }
    EXPECT_NE(path_refusal("1 2 3 0 0 nan 1\n").find("line 1"), std::string::npos);
}

TEST(ReadHandPath, refuses_rows_of_another_width_than_those_before) {
    EXPECT_NE(path_refusal("1 2 3 0 0 0 1\n1 2 3\n").find("line 2: 3 numbers (expected 7"),
              std::string::npos);
    EXPECT_NE(path_refusal("0 1 2 3\n1 1 2 3 0 0 0 1\n").find("line 2: 8 numbers (expected 4"),
              std::string::npos);
    EXPECT_NE(path_refusal("1 2 3 0 0 0 1\n1 1 2 3 0 0 0 1\n").find("line 2: 8 numbers (expected 7"),
              std::string::npos);
    for (const char* row : {"1 2 3 4 5\n", "1 2 3 4 5 6\n", "1 2 3 0 0 0 1 0 0 0\n"})
        EXPECT_NE(path_refusal(row).find("qx qy qz qw"), std::string::npos) << row;
}

TEST(ReadHandPath, lines_may_have_65535_characters) {
    const std::string longest = "1 2 3 #" + std::string(65535 - 7, 'x');
    EXPECT_EQ(read_hand_path(text_file(longest + "\n" + longest)).keys().size(), 2U);
    EXPECT_NE(path_refusal(longest + "\n" + longest + "x\n").find("line 2: more than 65535 characters"),
              std::string::npos);
}

TEST(ReadHandPath, names_file_and_line_of_what_is_wrong) {
    EXPECT_NE(path_refusal("1 2 3\n1 x 3\n").find("palpate_hand_path.txt, line 2"), std::string::npos);
    EXPECT_NE(path_refusal("1 2 3\n1 2 3 4\n").find("line 2: 4 numbers"), std::string::npos);
    EXPECT_NE(path_refusal("1 2\n").find("line 1: 2 numbers"), std::string::npos);
    EXPECT_NE(path_refusal("0 1 2 3\n0 1 2 3\n").find("line 2: time"), std::string::npos);
    EXPECT_NE(path_refusal("1 2 nan\n").find("line 1"), std::string::npos);
    EXPECT_NE(path_refusal("# nothing\n").find("no positions"), std::string::npos);
    EXPECT_NE(path_refusal(std::string("1 2 3\n1 2 3\0 4\n", 16)).find("line 2"), std::string::npos);
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

TEST(SimulatedDevice, is_turned_as_its_path_says_and_its_shaft_is_the_tools_z_axis) {
    const Quaterniond last = turn_by({2, -1, 0.5}, 120);
    SimulatedDevice device(
        HandPath({{0, {0, 0, 0}, true, Quaterniond::Identity()}, {1, {1, 2, 3}, true, last}}), {}, {1, 0, 0});
    const realtime::DeviceState state = device.read(0.25);
    EXPECT_LT(angle_between(quaternion_of(state.orientation), turn_by({2, -1, 0.5}, 30)), turning_error);
    EXPECT_LT((vector_of(state.shaft) - turn_by({2, -1, 0.5}, 30) * Vector3d::UnitZ()).norm(), turning_error);
    // Without one, its shaft stays as it was told.
    SimulatedDevice unturned(HandPath({{0, {0, 0, 0}}}), {}, {1, 0, 0});
    EXPECT_EQ(unturned.read(0).orientation, (std::array<double, 4>{0, 0, 0, 0}));
    EXPECT_EQ(unturned.read(0).shaft, (std::array<double, 3>{1, 0, 0}));
}

}  // namespace
}  // namespace palpate
