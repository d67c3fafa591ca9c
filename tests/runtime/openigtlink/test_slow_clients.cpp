// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <gtest/gtest.h>
#include <igtlTransformMessage.h>
#include <random>
#include <thread>

#include "runtime/openigtlink/session_stream.hpp"
#include "tests/runtime/openigtlink/igtl_peer.hpp"

namespace palpate {
namespace {

using namespace openigtlink;

const StreamSettings fast{{"127.0.0.1", 0}, 1000, 1, false};

// Publishes a tick with the most contacts there are, over and over, and counts them in the tool's x.
class Publisher {
  public:
    explicit Publisher(SessionStream& stream) {
        result_.contact_count = max_contacts;
        thread_ = std::thread([this, &stream] {
            while (!stop_) {
                result_.tool_position[0] -= 1;
                stream.publish(result_, points_);
                ++published_;
                std::this_thread::sleep_for(std::chrono::microseconds(500));
            }
        });
    }
    ~Publisher() { stop(); }
    /// Ends and tells how many there were.
    int stop() {
        stop_ = true;
        if (thread_.joinable()) thread_.join();
        return published_;
    }
    int published() const { return published_; }

  private:
    TickResult result_;
    std::vector<Eigen::Vector3d> points_ =
        std::vector<Eigen::Vector3d>(max_contacts, Eigen::Vector3d(1, 2, 3));
    std::atomic<bool> stop_{false};
    std::atomic<int> published_{0};
    std::thread thread_;
};

// What the tool's x is in the peer's next frame; -1 if none comes.
float next_count(WatchingPeer& peer) {
    const Received received = peer.next("TRANSFORM", "PalpateTool");
    if (received.type.empty()) return -1;
    igtl::Matrix4x4 m;
    received.as<igtl::TransformMessage>()->GetMatrix(m);
    return m[0][3];
}

TEST(SlowClients, two_clients_get_the_same_frames) {
    SessionStream stream(fast);
    WatchingPeer first(stream.port()), second(stream.port());
    ASSERT_TRUE(eventually([&] { return stream.report().connected == 2; }));
    const Publisher publisher(stream);
    for (int i = 0; i < 20; ++i) {
        const float count = next_count(first);
        ASSERT_GT(count, 0);
        EXPECT_EQ(next_count(second), count);
    }
}

TEST(SlowClients, one_that_reads_nothing_is_dropped_and_holds_up_nobody) {
    SessionStream stream(fast);
    WatchingPeer slow(stream.port()), quick(stream.port());
    ASSERT_TRUE(eventually([&] { return stream.report().connected == 2; }));
    const Publisher publisher(stream);
    float last = 0;
    const auto end = std::chrono::steady_clock::now() + 2 * long_enough;
    while (stream.report().dropped == 0 && std::chrono::steady_clock::now() < end) {
        const float count = next_count(quick);
        ASSERT_GT(count, last);
        last = count;
    }
    EXPECT_EQ(stream.report().dropped, 1u);
    EXPECT_GT(stream.report().skipped, 0u);
    EXPECT_GT(next_count(quick), last);
    EXPECT_TRUE(eventually([&] { return stream.report().connected == 1; }));
    EXPECT_GT(publisher.published(), 100);
}

TEST(SlowClients, one_that_pauses_gets_whole_messages_afterwards_up_to_the_last) {
    SessionStream stream(fast);
    WatchingPeer peer(stream.port());
    int published = 0;
    {
        Publisher publisher(stream);
        ASSERT_TRUE(eventually([&] {  // the system takes nothing more for the peer
            const std::uint64_t frames = stream.report().frames;
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
            return stream.report().skipped > 0 && stream.report().frames == frames;
        }));
        published = publisher.stop();
    }
    float last = 0;
    while (last < static_cast<float>(published)) {
        const Received received = peer.next();
        ASSERT_TRUE(received.device.starts_with("Palpate")) << "'" << received.device << "' after " << last;
        if (received.device != "PalpateTool") continue;
        const auto tool = received.as<igtl::TransformMessage>();
        ASSERT_TRUE(tool.IsNotNull());
        igtl::Matrix4x4 m;
        tool->GetMatrix(m);
        ASSERT_GT(m[0][3], last);
        last = m[0][3];
    }
}

TEST(SlowClients, those_that_vanish_or_flood_disturb_nobody) {
    SessionStream stream(fast);
    const Publisher publisher(stream);
    WatchingPeer quick(stream.port());
    std::mt19937 random(3);
    Bytes noise(300'000);
    for (std::byte& b : noise) b = static_cast<std::byte>(random());
    for (int i = 0; i < 10; ++i) {
        WatchingPeer rude(stream.port());
        rude.send(noise);
        rude.close();
        EXPECT_GT(next_count(quick), 0);
    }
    EXPECT_TRUE(eventually([&] {
        next_count(quick);
        return stream.report().connected == 1;
    }));
}

TEST(SlowClients, more_than_eight_are_turned_away) {
    SessionStream stream(fast);
    std::vector<std::unique_ptr<WatchingPeer>> peers;
    for (std::size_t i = 0; i < SessionStream::most_clients + 1; ++i)
        peers.push_back(std::make_unique<WatchingPeer>(stream.port()));
    ASSERT_TRUE(eventually([&] { return stream.report().refused == 1; }));
    EXPECT_EQ(peers.front()->next().type, "STATUS");
    EXPECT_EQ(peers.back()->next().type, "");
    peers.front()->close();
    ASSERT_TRUE(eventually([&] { return stream.report().connected == SessionStream::most_clients - 1; }));
    WatchingPeer late(stream.port());
    EXPECT_EQ(late.next().type, "STATUS");
}

}  // namespace
}  // namespace palpate
