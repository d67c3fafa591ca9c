// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <atomic>
#include <cstdint>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

#include "runtime/realtime/triple_buffer.hpp"

namespace palpate {
namespace {

using namespace realtime;

// Longer than a cache line; every word follows from the first.
struct Payload {
    std::array<std::uint64_t, 40> words;
    static Payload of(std::uint64_t seed) {
        Payload p;
        for (std::size_t i = 0; i < p.words.size(); ++i) p.words[i] = seed * (i + 1);
        return p;
    }
    bool whole() const {
        for (std::size_t i = 0; i < words.size(); ++i)
            if (words[i] != words[0] * (i + 1)) return false;
        return true;
    }
};
static_assert(!std::atomic<Payload>::is_always_lock_free, "small enough to be copied whole by accident");

TEST(TripleBuffer, starts_with_its_initial_value_and_nothing_fresh) {
    TripleBuffer<int> buffer(7);
    EXPECT_FALSE(buffer.refresh());
    EXPECT_EQ(buffer.front(), 7);
}

TEST(TripleBuffer, reads_the_latest_of_several_writes_once) {
    TripleBuffer<int> buffer;
    buffer.write(1);
    buffer.write(2);
    buffer.write(3);
    EXPECT_TRUE(buffer.refresh());
    EXPECT_EQ(buffer.front(), 3);
    EXPECT_FALSE(buffer.refresh());
    EXPECT_EQ(buffer.read(), 3);
}

TEST(TripleBuffer, never_tears_and_never_goes_back) {
    constexpr std::uint64_t writes = 1 << 18;
    TripleBuffer<Payload> buffer(Payload::of(0));
    std::thread writer([&] {
        for (std::uint64_t i = 1; i <= writes; ++i) buffer.write(Payload::of(i));
    });
    std::uint64_t last = 0;
    bool whole = true, monotonic = true;
    while (last < writes && whole && monotonic) {
        const Payload& payload = buffer.read();
        whole = payload.whole();
        monotonic = payload.words[0] >= last;
        last = payload.words[0];
    }
    writer.join();
    EXPECT_TRUE(whole);
    EXPECT_TRUE(monotonic);
}

TEST(TripleBuffer, fills_large_payloads_in_place) {
    TripleBuffer<std::vector<int>> buffer(std::vector<int>(1000, 0));
    const int* memory = buffer.back().data();
    buffer.back().assign(1000, 5);
    buffer.publish();
    EXPECT_EQ(buffer.read().front(), 5);
    EXPECT_EQ(buffer.front().data(), memory);
}

}  // namespace
}  // namespace palpate
