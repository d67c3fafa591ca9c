// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "runtime/openigtlink/contact_point.hpp"
#include "runtime/openigtlink/read_message.hpp"
#include "tests/runtime/openigtlink/igtl_peer.hpp"

namespace palpate {
namespace {

using namespace openigtlink;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();
// What a float32 of a few hundred millimetres, or of a rotation, may be off by.
constexpr double float_error = 3e-5;

// A quarter turn about x: y goes to z, z to -y. Then 10 mm to the right, 20 forwards, 30 up.
constexpr Rows quarter_turn{{{1, 0, 0, 10}, {0, 0, -1, 20}, {0, 1, 0, 30}, {0, 0, 0, 1}}};

Bytes body_of(const Bytes& whole) {
    return {whole.begin() + MessageHead::size, whole.end()};
}

std::optional<MessageHead> head_of(const Bytes& whole) {
    return read_head(std::span<const std::byte, MessageHead::size>(whole.data(), MessageHead::size));
}

PoseReading pose_in(const Bytes& whole) {
    return read_pose(head_of(whole).value(), body_of(whole));
}

void expect_near(const Eigen::Vector3d& found, const Eigen::Vector3d& expected) {
    EXPECT_LE((found - expected).norm(), float_error) << found.transpose() << " vs " << expected.transpose();
}

// By hand: right is -left, so x and y change sign. The tool's -z points, in RAS, along +y: forwards, which
// is -y in LPS.
void expect_quarter_turn(const PoseReading& reading) {
    ASSERT_TRUE(reading.pose.has_value()) << reading.problem;
    expect_near(reading.pose->tip, {-10, -20, 30});
    expect_near(reading.pose->shaft, {0, -1, 0});
}

TEST(ReadMessage, a_transform_in_ras_gives_tip_and_shaft_in_lps) {
    const Bytes whole = transform_message("Stylus", quarter_turn);
    const MessageHead head = head_of(whole).value();
    EXPECT_EQ(head.type, "TRANSFORM");
    EXPECT_EQ(head.device, "Stylus");
    EXPECT_EQ(head.body_size, 48u);
    EXPECT_TRUE(crc_fits(head, body_of(whole)));
    expect_quarter_turn(pose_in(whole));
}

TEST(ReadMessage, a_position_and_a_qtrans_give_the_same_pose) {
    const float half = std::sqrt(0.5F);
    const Bytes position = position_message("Stylus", {10, 20, 30}, {half, 0, 0, half});
    expect_quarter_turn(pose_in(position));
    expect_quarter_turn(pose_in(message("QTRANS", "Stylus", body_of(position))));
    Bytes three = body_of(position);
    three.resize(24);  // w is what is missing to a unit quaternion
    expect_quarter_turn(pose_in(message("POSITION", "Stylus", three)));
}

// A third of a turn about (1, 1, 1): in RAS, x goes to y, y to z, z to x.
constexpr Rows third_turn{{{0, 0, 1, 10}, {1, 0, 0, 20}, {0, 1, 0, 30}, {0, 0, 0, 1}}};

// By hand: the message's axes in RAS are x = (0, 1, 0), y = (0, 0, 1), z = (1, 0, 0), in LPS x = (0, -1, 0),
// y = (0, 0, 1), z = (-1, 0, 0). The tool's z is the shaft, against the message's: half a turn about x leaves
// x, and turns y and z round. So R, by columns, is (0, -1, 0), (0, 0, -1), (1, 0, 0).
void expect_third_turn(const PoseReading& reading) {
    ASSERT_TRUE(reading.pose.has_value()) << reading.problem;
    const Eigen::Quaterniond& orientation = reading.pose->orientation;
    EXPECT_NEAR(orientation.norm(), 1, 1e-12);
    expect_near(orientation * Eigen::Vector3d::UnitX(), {0, -1, 0});
    expect_near(orientation * Eigen::Vector3d::UnitY(), {0, 0, -1});
    expect_near(orientation * Eigen::Vector3d::UnitZ(), {1, 0, 0});
    expect_near(reading.pose->shaft, {1, 0, 0});
}

TEST(ReadMessage, a_transform_a_qtrans_and_a_position_give_the_orientation_in_lps_whose_z_is_the_shaft) {
    expect_third_turn(pose_in(transform_message("Stylus", third_turn)));
    const Bytes position = position_message("Stylus", {10, 20, 30}, {0.5F, 0.5F, 0.5F, 0.5F});
    expect_third_turn(pose_in(position));
    expect_third_turn(pose_in(message("QTRANS", "Stylus", body_of(position))));
    Bytes three = body_of(position);
    three.resize(24);
    expect_third_turn(pose_in(message("POSITION", "Stylus", three)));
}

TEST(ReadMessage, a_position_without_orientation_has_no_shaft) {
    Bytes body = body_of(position_message("Stylus", {10, 20, 30}, {0, 0, 0, 1}));
    body.resize(12);
    const PoseReading reading = pose_in(message("POSITION", "Stylus", body));
    expect_near(reading.pose.value().tip, {-10, -20, 30});
    EXPECT_EQ(reading.pose->shaft, Eigen::Vector3d(0, 0, 0));
    EXPECT_EQ(reading.pose->orientation.coeffs(), Eigen::Vector4d(0, 0, 0, 0));
}

TEST(ReadMessage, a_message_of_version_2_is_read_between_its_extended_head_and_metadata) {
    const Bytes content = body_of(transform_message("Stylus", quarter_turn));
    // 12 bytes of extended head (its size, then that of 2 bytes of index and 5 of metadata), then content.
    Bytes body(12 + content.size() + 2 + 5);
    body[1] = std::byte{12};
    body[3] = std::byte{2};
    body[7] = std::byte{5};
    std::copy(content.begin(), content.end(), body.begin() + 12);
    expect_quarter_turn(pose_in(message("TRANSFORM", "Stylus", body, 2)));

    for (const auto& [place, value] : {std::pair{1, 11}, {1, 200}, {0, 255}, {3, 80}, {4, 255}, {7, 200}}) {
        Bytes hostile = body;
        hostile[static_cast<std::size_t>(place)] = static_cast<std::byte>(value);
        EXPECT_FALSE(pose_in(message("TRANSFORM", "Stylus", hostile, 2)).pose) << place << " = " << value;
    }
}

TEST(ReadMessage, what_is_no_rigid_pose_is_refused_with_a_reason) {
    Rows scaled = quarter_turn, mirrored = quarter_turn, sheared = quarter_turn, unknown = quarter_turn,
         endless = quarter_turn, far = quarter_turn;
    for (auto& row : scaled) row[0] *= 1.01F;
    for (auto& row : mirrored) row[0] *= -1;
    sheared[0][1] = 0.01F;
    unknown[1][1] = nan;
    endless[2][3] = infinite;
    far[0][3] = 1e9F;
    for (const Rows& matrix : {scaled, mirrored, sheared, unknown, endless, far}) {
        const PoseReading reading = pose_in(transform_message("Stylus", matrix));
        EXPECT_FALSE(reading.pose);
        EXPECT_FALSE(reading.problem.empty());
    }
    for (const std::array<float, 4>& q : {std::array{0.F, 0.F, 0.F, 0.F}, {1, 1, 0, 0}, {nan, 0, 0, 1}})
        EXPECT_FALSE(pose_in(position_message("Stylus", {0, 0, 0}, q)).pose);
    EXPECT_FALSE(pose_in(message("TRANSFORM", "Stylus", Bytes(47))).pose);
    EXPECT_FALSE(pose_in(message("POSITION", "Stylus", Bytes(20))).pose);
}

TEST(ReadMessage, a_float32_rotation_at_any_angle_is_taken) {
    std::mt19937 random(6);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 1000; ++i) {
        const Eigen::Quaterniond q =
            Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
        const Eigen::Matrix3f R = q.toRotationMatrix().cast<float>();
        Rows matrix{};
        for (Eigen::Index row = 0; row < 3; ++row)
            for (Eigen::Index column = 0; column < 3; ++column)
                matrix[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = R(row, column);
        const PoseReading reading = pose_in(transform_message("Stylus", matrix));
        ASSERT_TRUE(reading.pose);
        expect_near(reading.pose->orientation * Eigen::Vector3d::UnitZ(), reading.pose->shaft);
    }
}

// Whatever comes is refused, or is a pose that is safe to use.
TEST(ReadMessage, random_and_mutated_bytes_never_give_a_pose_that_is_no_number) {
    std::mt19937 random(2026);
    const Bytes good = transform_message("Stylus", quarter_turn);
    int poses = 0;
    for (int i = 0; i < 200'000; ++i) {
        Bytes bytes = good;
        if (i % 4 == 0) {
            for (std::byte& b : bytes) b = static_cast<std::byte>(random());
        } else {
            for (unsigned k = 0; k < 1 + random() % 4; ++k)
                bytes[random() % bytes.size()] = static_cast<std::byte>(random());
        }
        const auto head = head_of(bytes);
        if (!head) continue;
        bytes.resize(MessageHead::size + random() % 64);
        (void)read_status_code(*head, body_of(bytes));
        (void)crc_fits(*head, body_of(bytes));
        for (const PoseReading& reading : {read_pose(*head, body_of(bytes)), pose_in(good)}) {
            if (!reading.pose) continue;
            ++poses;
            ASSERT_TRUE(reading.pose->tip.allFinite());
            const double length = reading.pose->shaft.isZero(0) ? 0 : 1;
            ASSERT_NEAR(reading.pose->shaft.norm(), length, 1e-12);
            ASSERT_NEAR(reading.pose->orientation.norm(), length, 1e-12);
        }
    }
    EXPECT_GT(poses, 0);
}

TEST(ReadMessage, what_is_no_head_is_refused) {
    Bytes bytes = transform_message("Stylus", quarter_turn);
    const auto with = [&](std::size_t place, int value) {
        Bytes changed = bytes;
        changed[place] = static_cast<std::byte>(value);
        return head_of(changed);
    };
    EXPECT_TRUE(with(1, 3));
    EXPECT_FALSE(with(1, 0));
    EXPECT_FALSE(with(1, 4));
    EXPECT_FALSE(with(0, 1));
    EXPECT_FALSE(with(2, 0));
    EXPECT_FALSE(with(3, 7));
    EXPECT_FALSE(with(42, 128));  // the first byte of the body's size
    EXPECT_EQ(with(14, 7)->device, "?tylus");
}

TEST(RotationWithZ, is_a_rotation_whose_z_is_the_axis_even_against_z) {
    for (const Eigen::Vector3d& axis :
         {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(0.6, 0, -0.8),
          Eigen::Vector3d(1, 2, 3).normalized()}) {
        const Eigen::Matrix3d R = rotation_with_z(axis);
        EXPECT_LE((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-14);
        EXPECT_NEAR(R.determinant(), 1, 1e-14);
        EXPECT_LE((R.col(2) - axis).norm(), 1e-14);
    }
    EXPECT_EQ(rotation_with_z({0, 0, 0}), Eigen::Matrix3d::Identity());
}

TEST(FlipAxes, gives_a_rotation_and_undoes_itself) {
    const Eigen::Matrix3d R =
        Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
    EXPECT_NEAR(flip_axes(R).determinant(), 1, 1e-14);
    EXPECT_EQ(flip_axes(flip_axes(R)), R);
    EXPECT_EQ(flip_axes(R).col(2), flip_lps_ras(-R.col(2)));
}

TEST(ContactPoint, is_the_weighted_sum_of_the_vertices_given) {
    const std::vector<Eigen::Vector3d> vertices{{0, 0, 0}, {4, 0, 0}, {0, 8, 0}, {1, 1, 1}};
    Contact contact;
    contact.vertices = {0, 1, 2};
    contact.weights = {0.25F, 0.5F, 0.25F};
    EXPECT_EQ(contact_point(contact, vertices), Eigen::Vector3d(2, 2, 0));
    contact.vertices = {3, -1, -1};
    contact.weights = {1, 0, 0};
    EXPECT_EQ(contact_point(contact, vertices), Eigen::Vector3d(1, 1, 1));
}

}  // namespace
}  // namespace palpate
