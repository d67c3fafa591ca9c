// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gtest/gtest.h>
#include <igtlPointMessage.h>
#include <igtlSensorMessage.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>
#include <limits>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/openigtlink/session_stream.hpp"
#include "tests/runtime/openigtlink/igtl_peer.hpp"

namespace palpate {
namespace {

using namespace openigtlink;

// A tool 3 mm beside its device, pushed by 2.5 N; its shaft goes to the patient's back (+y in LPS).
TickResult sample() {
    TickResult result;
    result.tool_position = {1, 2, 3};
    result.device_position = {1, 2, 6};
    result.shaft = {0, 1, 0};
    result.force = {1.5, 0, -2};
    result.contact_count = 2;
    result.contacts[0].force = 0.42F;
    result.contacts[1].force = 2;
    return result;
}
const std::vector<Eigen::Vector3d> sample_points{{10, 20, 30}, {-1, -2, -3}};

StreamSettings any_port(std::size_t tools = 1, bool sensor = false) {
    return {{"127.0.0.1", 0}, 60, tools, sensor};
}

std::array<float, 3> column(igtl::TransformMessage& message, int which) {
    igtl::Matrix4x4 m;
    message.GetMatrix(m);
    return {m[0][which], m[1][which], m[2][which]};
}

TEST(SessionStream, sends_tool_device_and_force_as_slicer_reads_them) {
    SessionStream stream(any_port());
    stream.publish(sample(), sample_points);
    WatchingPeer peer(stream.port());

    // In RAS: x and y change sign. The shaft is (0, -1, 0), so z of the tool, away from it, is (0, 1, 0).
    auto tool = peer.next("TRANSFORM", "PalpateTool").as<igtl::TransformMessage>();
    ASSERT_TRUE(tool.IsNotNull());
    EXPECT_EQ(column(*tool, 3), (std::array{-1.F, -2.F, 3.F}));
    EXPECT_NEAR(column(*tool, 2)[1], 1, 1e-6);
    EXPECT_NEAR(std::hypot(column(*tool, 0)[0], column(*tool, 0)[1], column(*tool, 0)[2]), 1, 1e-6);
    unsigned seconds = 0, fraction = 0;
    tool->GetTimeStamp(&seconds, &fraction);
    EXPECT_GT(seconds, 1'700'000'000u);  // later than 2023

    auto device = peer.next("TRANSFORM", "PalpateDevice").as<igtl::TransformMessage>();
    ASSERT_TRUE(device.IsNotNull());
    EXPECT_EQ(column(*device, 3), (std::array{-1.F, -2.F, 6.F}));

    auto arrow = peer.next("TRANSFORM", "PalpateForce").as<igtl::TransformMessage>();
    ASSERT_TRUE(arrow.IsNotNull());
    EXPECT_EQ(column(*arrow, 3), (std::array{-1.F, -2.F, 3.F}));
    EXPECT_NEAR(column(*arrow, 2)[0], -1.5, 1e-6);
    EXPECT_NEAR(column(*arrow, 2)[2], -2, 1e-6);

    auto text = peer.next("STRING", "PalpateForce").as<igtl::StringMessage>();
    ASSERT_TRUE(text.IsNotNull());
    EXPECT_STREQ(text->GetString(), "-1.5000 -0.0000 -2.0000 N");
}

TEST(SessionStream, sends_contact_points_labelled_with_their_force) {
    SessionStream stream(any_port());
    stream.publish(sample(), sample_points);
    WatchingPeer peer(stream.port());
    auto points = peer.next("POINT", "PalpateContacts").as<igtl::PointMessage>();
    ASSERT_TRUE(points.IsNotNull());
    ASSERT_EQ(points->GetNumberOfPointElement(), 2);
    igtl::PointElement::Pointer point;
    points->GetPointElement(0, point);
    std::array<float, 3> place{};
    point->GetPosition(place.data());
    EXPECT_EQ(place, (std::array{-10.F, -20.F, 30.F}));
    EXPECT_STREQ(point->GetName(), "0.42 N");
    points->GetPointElement(1, point);
    point->GetPosition(place.data());
    EXPECT_EQ(place, (std::array{1.F, 2.F, -3.F}));
    EXPECT_STREQ(point->GetName(), "2.00 N");
    std::array<igtlUint8, 4> rgba{};
    point->GetRGBA(rgba.data());
    EXPECT_EQ(rgba[3], 255);
}

TEST(SessionStream, without_contact_sends_one_hidden_point) {
    SessionStream stream(any_port());
    TickResult free = sample();
    free.contact_count = 0;
    stream.publish(free, {});
    WatchingPeer peer(stream.port());
    auto points = peer.next("POINT", "PalpateContacts").as<igtl::PointMessage>();
    ASSERT_TRUE(points.IsNotNull());
    ASSERT_EQ(points->GetNumberOfPointElement(), 1);
    igtl::PointElement::Pointer point;
    points->GetPointElement(0, point);
    std::array<igtlUint8, 4> rgba{};
    point->GetRGBA(rgba.data());
    EXPECT_EQ(rgba[3], 0);
}

TEST(SessionStream, sends_the_force_as_sensor_where_asked) {
    SessionStream stream(any_port(1, true));
    stream.publish(sample(), {});
    WatchingPeer peer(stream.port());
    auto sensor = peer.next("SENSOR", "PalpateForce").as<igtl::SensorMessage>();
    ASSERT_TRUE(sensor.IsNotNull());
    ASSERT_EQ(sensor->GetLength(), 3u);
    EXPECT_EQ(sensor->GetValue(0), -1.5);
    EXPECT_EQ(sensor->GetValue(2), -2);
    auto newton = igtl::Unit::New();
    newton->Append(igtl::Unit::SI_DERIVED_NEWTON, 1);
    EXPECT_EQ(sensor->GetUnit(), newton->Pack());
}

TEST(SessionStream, sends_only_what_slicer_knows_unless_asked) {
    SessionStream stream(any_port());
    stream.publish(sample(), sample_points);
    WatchingPeer peer(stream.port());
    std::vector<std::string> seen;
    for (int i = 0; i < 6; ++i) {
        const Received received = peer.next();
        seen.push_back(received.type + " " + received.device);
    }
    EXPECT_EQ(seen, (std::vector<std::string>{"STATUS PalpateStatus", "TRANSFORM PalpateTool",
                                              "TRANSFORM PalpateDevice", "TRANSFORM PalpateForce",
                                              "STRING PalpateForce", "POINT PalpateContacts"}));
}

TEST(SessionStream, sends_the_torque_of_a_tool_that_turns_and_of_no_other) {
    SessionStream stream(any_port(2));
    TickResult ball = sample();
    ball.torque = {9, 9, 9};
    stream.publish(ball, {});
    TickResult instrument = sample();
    instrument.tool = 1;
    instrument.tool_orientation = {0, 0, 0, 1};
    instrument.torque = {1.5, -2, 40};
    stream.publish(instrument, {});
    WatchingPeer peer(stream.port());
    for (;;) {
        const Received received = peer.next();
        ASSERT_NE(received.type, "") << "the frame's last message is POINT PalpateContacts2";
        EXPECT_NE(received.device, "PalpateTorque");
        if (received.device != "PalpateTorque2") continue;
        const auto text = received.as<igtl::StringMessage>();
        ASSERT_TRUE(text.IsNotNull());
        EXPECT_STREQ(text->GetString(), "-1.5000 2.0000 40.0000 N mm");
        break;
    }
}

TEST(SessionStream, tells_of_faults_when_they_change) {
    SessionStream stream(any_port());
    WatchingPeer peer(stream.port());
    auto status = peer.next("STATUS", "PalpateStatus").as<igtl::StatusMessage>();
    ASSERT_TRUE(status.IsNotNull());
    EXPECT_EQ(status->GetCode(), igtl::StatusMessage::STATUS_OK);
    EXPECT_STREQ(status->GetStatusString(), "no fault");

    // There for one publication only, sooner gone than a frame is made.
    TickResult result = sample();
    result.faults = motors_warm | tick_late;
    stream.publish(result, {});
    result.faults = no_fault;
    stream.publish(result, {});
    status = peer.next("STATUS", "PalpateStatus").as<igtl::StatusMessage>();
    ASSERT_TRUE(status.IsNotNull());
    EXPECT_EQ(status->GetCode(), igtl::StatusMessage::STATUS_HARDWARE_FAILURE);
    EXPECT_EQ(status->GetSubCode(), std::int64_t{motors_warm | tick_late});
    EXPECT_STREQ(status->GetErrorName(), "motors_warm");
    EXPECT_STREQ(status->GetStatusString(), "motors_warm+tick_late: the device's motors are too warm");
    status = peer.next("STATUS", "PalpateStatus").as<igtl::StatusMessage>();
    ASSERT_TRUE(status.IsNotNull());
    EXPECT_EQ(status->GetCode(), igtl::StatusMessage::STATUS_OK);
}

TEST(SessionStream, names_every_fault_within_the_field_that_status_has) {
    for (const FaultText& text : fault_texts()) EXPECT_LE(std::string(text.name).size(), 19u) << text.name;
}

TEST(SessionStream, sends_no_number_that_is_none) {
    SessionStream stream(any_port());
    TickResult result = sample();
    result.device_position[1] = std::numeric_limits<double>::quiet_NaN();
    result.faults = invalid_position;
    stream.publish(result, {});
    WatchingPeer peer(stream.port());
    EXPECT_EQ(peer.next().type, "STATUS");
    result.device_position[1] = 2;
    stream.publish(result, {});
    const auto tool = peer.next().as<igtl::TransformMessage>();
    ASSERT_TRUE(tool.IsNotNull());
    EXPECT_EQ(column(*tool, 3), (std::array{-1.F, -2.F, 3.F}));
}

TEST(SessionStream, numbers_the_tools_after_the_first) {
    SessionStream stream(any_port(2));
    TickResult second = sample();
    second.tool = 1;
    second.tool_position = {7, 8, 9};
    stream.publish(second, {});
    TickResult third = sample();
    third.tool = 2;  // there is none
    stream.publish(third, {});
    WatchingPeer peer(stream.port());
    EXPECT_EQ(peer.next().type, "STATUS");
    const Received first = peer.next();  // of the first tool nothing is known
    EXPECT_EQ(first.device, "PalpateTool2");
    const auto tool = first.as<igtl::TransformMessage>();
    ASSERT_TRUE(tool.IsNotNull());
    EXPECT_EQ(column(*tool, 3), (std::array{-7.F, -8.F, 9.F}));
}

TEST(SessionStream, can_be_followed_as_a_tracker) {
    SessionStream stream(any_port());
    TickResult result = sample();
    result.shaft = {0.48, -0.6, 0.64};
    stream.publish(result, {});
    TrackedDevice device({{"127.0.0.1", stream.port()}, "PalpateTool"}, {long_enough, long_enough});
    const realtime::DeviceState state = device.read(0);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(state.position[i], result.tool_position[i], 1e-6);
        EXPECT_NEAR(state.shaft[i], result.shaft[i], 1e-6);
    }
}

TEST(SessionStream, of_a_tool_that_turns_the_orientation_comes_back_to_who_follows_it) {
    SessionStream stream(any_port());
    TickResult result = sample();
    const Eigen::Quaterniond tool(Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, 2, -3).normalized()));
    const Eigen::Quaterniond device(Eigen::AngleAxisd(-0.8, Eigen::Vector3d(0, 1, 1).normalized()));
    result.tool_orientation = array_of(tool);
    result.orientation = array_of(device);
    result.shaft = array_of(Eigen::Vector3d(device * Eigen::Vector3d::UnitZ()));
    stream.publish(result, {});
    for (const auto& [name, sent] : {std::pair{"PalpateTool", tool}, {"PalpateDevice", device}}) {
        TrackedDevice follower({{"127.0.0.1", stream.port()}, name}, {long_enough, long_enough});
        const realtime::DeviceState state = follower.read(0);
        // q and -q are the same rotation.
        EXPECT_NEAR(std::abs(quaternion_of(state.orientation).dot(sent)), 1, 1e-12) << name;
        EXPECT_LT((quaternion_of(state.orientation).toRotationMatrix() - sent.toRotationMatrix()).norm(),
                  1e-6)
            << name;
        EXPECT_LT((vector_of(state.shaft) - sent * Eigen::Vector3d::UnitZ()).norm(), 1e-6) << name;
    }
}

// As of a rod that its device turns, or of a shell in a tick without a position.
TEST(SessionStream, a_tool_that_does_not_turn_by_itself_is_shown_as_its_device_is_turned) {
    SessionStream stream(any_port());
    TickResult result = sample();
    const Eigen::Quaterniond device(Eigen::AngleAxisd(1.3, Eigen::Vector3d(2, 0, 1).normalized()));
    result.orientation = array_of(device);
    stream.publish(result, {});
    TrackedDevice follower({{"127.0.0.1", stream.port()}, "PalpateTool"}, {long_enough, long_enough});
    EXPECT_LT(
        (quaternion_of(follower.read(0).orientation).toRotationMatrix() - device.toRotationMatrix()).norm(),
        1e-6);
}

TEST(SessionStream, sends_no_orientation_that_is_no_number) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    for (const auto orientation : {&TickResult::orientation, &TickResult::tool_orientation}) {
        SessionStream stream(any_port());
        TickResult result = sample();
        (result.*orientation)[2] = nan;
        stream.publish(result, {});
        WatchingPeer peer(stream.port());
        EXPECT_EQ(peer.next().type, "STATUS");
        result.*orientation = {0, 0, 0, 1};
        result.tool_position = {7, 8, 9};
        stream.publish(result, {});
        const auto tool = peer.next("TRANSFORM", "PalpateTool").as<igtl::TransformMessage>();
        ASSERT_TRUE(tool.IsNotNull());
        EXPECT_EQ(column(*tool, 3), (std::array{-7.F, -8.F, 9.F}));  // the first frame that came
    }
}

TEST(SessionStream, says_which_port_it_cannot_have) {
    const SessionStream first(any_port());
    StreamSettings same = any_port();
    same.address.port = first.port();
    try {
        const SessionStream second(same);
        ADD_FAILURE() << "two servers at one port";
    } catch (const SystemFailure& error) {
        EXPECT_EQ(error.detail().culprit, to_string(same.address));
        EXPECT_EQ(error.detail().found, "Address already in use");
    }
    EXPECT_THROW(SessionStream(StreamSettings{{"192.0.2.1", 0}}), InvalidInput);  // no machine has this one
    EXPECT_THROW(SessionStream(StreamSettings{{"127.0.0.1", 0}, 0}), InvalidInput);
}

TEST(SessionStream, can_have_its_port_again_at_once) {
    StreamSettings settings = any_port();
    for (int i = 0; i < 3; ++i) {
        SessionStream stream(settings);
        settings.address.port = stream.port();
        WatchingPeer peer(stream.port());
        EXPECT_EQ(peer.next().type, "STATUS");
    }
}

}  // namespace
}  // namespace palpate
