// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <limits>

#include "formats/model/errors.hpp"
#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/openigtlink/igtl_peer.hpp"

namespace palpate {
namespace {

using namespace openigtlink;
using std::chrono::milliseconds;

constexpr Rows at(float x, float y, float z) {
    return {{{1, 0, 0, x}, {0, 1, 0, y}, {0, 0, 1, z}, {0, 0, 0, 1}}};
}

TEST(TrackedDevice, gives_the_pose_in_lps_and_no_limits) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(10, 20, 30)));
    const realtime::DeviceState state = device->read(0.25);
    EXPECT_EQ(state.time, 0.25);
    EXPECT_EQ(state.position, (std::array{-10.0, -20.0, 30.0}));
    EXPECT_EQ(state.shaft, (std::array{0.0, 0.0, -1.0}));
    EXPECT_EQ(state.faults, no_fault);
    EXPECT_EQ(device->limits().max_force, 0);
    EXPECT_NE(device->name().find("'Stylus'"), std::string::npos);

    peer.send(transform_message("Stylus", at(1, 2, 3)));
    EXPECT_TRUE(eventually([&] { return device->read(0).position[2] == 3; }));
    peer.send(position_message("Stylus", {4, 5, 6}, {0, 0, 0, 1}));
    EXPECT_TRUE(eventually([&] { return device->read(0).position[2] == 6; }));
}

TEST(TrackedDevice, reading_allocates_nothing) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(10, 20, 30)));
    const AllocationTrap trap;
    for (int i = 0; i < 1000; ++i) {
        device->read(1e-3 * i);
        device->write({{1, 2, 3}});
    }
    EXPECT_EQ(trap.count(), 0u);
}

TEST(TrackedDevice, follows_one_name_and_no_other) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(1, 0, 0)));
    peer.send(transform_message("Probe", at(5, 0, 0)));
    peer.send(transform_message("StylusTip", at(6, 0, 0)));
    peer.send(status_message("", 0));
    peer.send(status_message("Probe", 13));
    peer.send(transform_message("Stylus", at(2, 0, 0)));
    EXPECT_TRUE(eventually([&] { return device->report().poses == 2; }));
    EXPECT_EQ(device->read(0).position[0], -2);
    EXPECT_EQ(device->read(0).faults, no_fault);
}

TEST(TrackedDevice, without_a_name_follows_the_first_pose) {
    TrackerPeer peer;
    const auto device = peer.device("", transform_message("Probe", at(1, 0, 0)));
    EXPECT_NE(device->name().find("'Probe'"), std::string::npos);
    peer.send(transform_message("Stylus", at(7, 0, 0)));
    peer.send(transform_message("Probe", at(2, 0, 0)));
    EXPECT_TRUE(eventually([&] { return device->report().poses == 2; }));
    EXPECT_EQ(device->read(0).position[0], -2);
}

TEST(TrackedDevice, is_lost_while_no_pose_comes_and_found_with_the_next) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(1, 0, 0)), milliseconds(100));
    EXPECT_TRUE(eventually([&] { return device->read(0).faults == device_lost; }));
    EXPECT_EQ(device->read(0).position[0], -1);
    EXPECT_TRUE(device->report().connected);
    EXPECT_TRUE(eventually([&] {
        peer.send(transform_message("Stylus", at(2, 0, 0)));
        return device->read(0).faults == no_fault;
    }));
    EXPECT_EQ(device->read(0).position[0], -2);
}

TEST(TrackedDevice, connects_again_by_itself) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(1, 0, 0)));
    peer.close_connection();
    EXPECT_TRUE(eventually([&] { return device->read(0).faults == device_lost; }));
    ASSERT_TRUE(peer.accept());
    peer.send(transform_message("Stylus", at(2, 0, 0)));
    EXPECT_TRUE(eventually([&] { return device->read(0).faults == no_fault; }));
    EXPECT_EQ(device->read(0).position[0], -2);
    EXPECT_EQ(device->report().reconnections, 1u);
}

TEST(TrackedDevice, keeps_the_last_good_position_under_a_pose_that_is_none) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(1, 0, 0)));
    Rows unknown = at(9, 0, 0), mirrored = at(9, 0, 0);
    unknown[0][3] = std::numeric_limits<float>::quiet_NaN();
    mirrored[0][0] = -1;
    std::uint64_t refused = 0;
    for (const Rows& wrong : {unknown, mirrored}) {
        peer.send(transform_message("Stylus", wrong));
        ++refused;
        EXPECT_TRUE(eventually([&] { return device->report().refused == refused; }));
        EXPECT_EQ(device->read(0).faults, invalid_position);
        EXPECT_EQ(device->read(0).position[0], -1);
        EXPECT_NE(device->report().last_problem.find("'Stylus'"), std::string::npos);
        peer.send(transform_message("Stylus", at(1, 0, 0)));
        EXPECT_TRUE(eventually([&] { return device->read(0).faults == no_fault; }));
    }
}

TEST(TrackedDevice, takes_a_status_of_its_tool_for_an_invalid_position) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(1, 0, 0)));
    peer.send(status_message("Stylus", 16));
    EXPECT_TRUE(eventually([&] { return device->read(0).faults == invalid_position; }));
    EXPECT_EQ(device->report().last_problem, "STATUS of 'Stylus': code 16");
    peer.send(status_message("Stylus", 1));
    peer.send(transform_message("Stylus", at(2, 0, 0)));
    EXPECT_TRUE(eventually([&] { return device->read(0).faults == no_fault; }));
}

TEST(TrackedDevice, drops_and_counts_what_a_wrong_crc_belies) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(1, 0, 0)));
    Bytes changed = transform_message("Stylus", at(5, 0, 0));
    changed.back() ^= std::byte{1};
    peer.send(changed);
    EXPECT_TRUE(eventually([&] { return device->report().crc_errors == 1; }));
    EXPECT_EQ(device->read(0).position[0], -1);
    EXPECT_EQ(device->read(0).faults, no_fault);
    peer.send(transform_message("Stylus", at(2, 0, 0)));
    EXPECT_TRUE(eventually([&] { return device->read(0).position[0] == -2; }));
}

std::string refusal(const TrackerAddress& address, milliseconds patience) {
    try {
        const TrackedDevice device(address, {patience, milliseconds(100)});
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "none";
}

TEST(TrackedDevice, without_a_server_says_where_it_looked) {
    TrackerAddress nobody = parse_tracker_address("127.0.0.1:1/Stylus");
    {
        const TcpSocket taken = listen_at({"127.0.0.1", 0});
        nobody.server.port = port_of(taken);
    }
    const std::string text = refusal(nobody, milliseconds(100));
    EXPECT_EQ(text.find(to_string(nobody.server) + ": no connection: Connection refused"), 0u) << text;
    EXPECT_NE(refusal(parse_tracker_address("no such host:1"), milliseconds(100))
                  .find("host 'no such host' was not found"),
              std::string::npos);
}

TEST(TrackedDevice, without_its_tool_says_what_came_instead) {
    TrackerPeer peer;
    auto text = std::async(std::launch::async, refusal, peer.address("Stylus"), milliseconds(1500));
    ASSERT_TRUE(peer.accept());
    peer.send(transform_message("Probe", at(0, 0, 0)));
    peer.send(message("IMAGE", "Reference", Bytes(100'000)));
    EXPECT_EQ(text.get(), to_string(peer.address("").server) +
                              ": connected, but only IMAGE messages 'Reference', TRANSFORM messages 'Probe' "
                              "came in 1500 ms (expected TRANSFORM messages 'Stylus'); start the server, let "
                              "it send the tool's transform, and name that transform");
}

TEST(TrackedDevice, whose_server_is_silent_says_so) {
    TrackerPeer peer;
    auto text = std::async(std::launch::async, refusal, peer.address(""), milliseconds(500));
    ASSERT_TRUE(peer.accept());
    EXPECT_NE(text.get().find("connected, but no message came in 500 ms (expected TRANSFORM messages)"),
              std::string::npos);
}

}  // namespace
}  // namespace palpate
