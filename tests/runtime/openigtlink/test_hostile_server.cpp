// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <gtest/gtest.h>
#include <random>
#include <unistd.h>

#include "tests/runtime/openigtlink/igtl_peer.hpp"

namespace palpate {
namespace {

constexpr Rows at(float x) {
    return {{{1, 0, 0, x}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
}

// The device gives up the connection by itself, comes back and takes the next pose.
void expect_recovery(TrackerPeer& peer, openigtlink::TrackedDevice& device, float x) {
    EXPECT_TRUE(eventually([&] { return device.read(0).faults == device_lost; }));
    ASSERT_TRUE(peer.accept());
    peer.send(transform_message("Stylus", at(x)));
    EXPECT_TRUE(eventually([&] { return device.read(0).position[0] == static_cast<double>(-x); }));
    EXPECT_EQ(device.read(0).faults, no_fault);
}

std::size_t resident_bytes() {
    std::ifstream statm("/proc/self/statm");
    std::size_t total = 0, resident = 0;
    statm >> total >> resident;
    return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

TEST(HostileServer, that_talks_nonsense_is_left_and_tried_again) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(1)));
    std::mt19937 random(7);
    Bytes noise(100'000);
    for (std::byte& b : noise) b = static_cast<std::byte>(random());
    noise[0] = std::byte{255};  // a version that there is not
    peer.send(noise);
    expect_recovery(peer, *device, 2);
    EXPECT_EQ(device->report().last_problem, "what came is not OpenIGTLink");
}

TEST(HostileServer, whose_messages_are_cut_short_is_tried_again) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(1)));
    const Bytes whole = transform_message("Stylus", at(5));
    float x = 2;
    for (const std::size_t length : {1u, 57u, 58u, 59u, 105u}) {
        peer.send(std::span(whole).first(length));
        peer.close_connection();
        expect_recovery(peer, *device, x++);
    }
}

TEST(HostileServer, that_stops_within_a_message_is_left) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(1)));
    const Bytes whole = transform_message("Stylus", at(5));
    peer.send(std::span(whole).first(60));
    expect_recovery(peer, *device, 2);
    EXPECT_EQ(device->report().last_problem, "the server stopped within a message");
}

TEST(HostileServer, that_announces_an_endless_body_is_left) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(1)));
    Bytes endless = transform_message("Stylus", at(5));
    for (std::size_t i = 42; i < 50; ++i) endless[i] = std::byte{255};  // the body's size
    peer.send(endless);
    expect_recovery(peer, *device, 2);
}

TEST(HostileServer, that_sends_large_images_costs_no_memory) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(1)));
    const Bytes image = message("IMAGE", "CT", Bytes(64 << 20));
    const Bytes pose_too_large = message("TRANSFORM", "Stylus", Bytes(64 << 20));
    const std::size_t before = resident_bytes();
    peer.send(image);
    peer.send(pose_too_large);
    peer.send(transform_message("Stylus", at(2)));
    EXPECT_TRUE(eventually([&] { return device->read(0).position[0] == -2; }));
    EXPECT_EQ(device->read(0).faults, no_fault);
    EXPECT_EQ(device->report().refused, 1u);
    EXPECT_LT(resident_bytes(), before + (16 << 20));  // of the 128 MiB that came
}

// What a sanitizer holds back of the memory that was given back, to see it used again.
#ifdef PALPATE_SANITIZED
constexpr std::size_t quarantine = 8 << 20;
#else
constexpr std::size_t quarantine = 0;
#endif

TEST(HostileServer, that_changes_names_without_end_costs_no_memory) {
    TrackerPeer peer;
    const auto device = peer.device("Stylus", transform_message("Stylus", at(1)));
    Bytes many;
    for (int i = 0; i < 100'000; ++i) {
        const Bytes one = message("STATUS", std::to_string(i), Bytes(0));
        many.insert(many.end(), one.begin(), one.end());
    }
    const std::size_t before = resident_bytes();
    peer.send(many);
    peer.send(transform_message("Stylus", at(2)));
    EXPECT_TRUE(eventually([&] { return device->read(0).position[0] == -2; }));
    EXPECT_LT(resident_bytes(), before + (8 << 20) + quarantine);
}

}  // namespace
}  // namespace palpate
