// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <thread>

#include "runtime/realtime/spsc_ring.hpp"

namespace palpate {
namespace {

using namespace realtime;

TEST(SpscRing, keeps_order_and_counts_what_it_drops) {
    SpscRing<int> ring(3);
    EXPECT_EQ(ring.capacity(), 4U);
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.push(i));
    EXPECT_FALSE(ring.push(4));
    EXPECT_EQ(ring.dropped(), 1U);
    int value = -1;
    EXPECT_TRUE(ring.pop(value));
    EXPECT_EQ(value, 0);
    EXPECT_TRUE(ring.push(5));
    for (const int expected : {1, 2, 3, 5}) {
        EXPECT_TRUE(ring.pop(value));
        EXPECT_EQ(value, expected);
    }
    EXPECT_FALSE(ring.pop(value));
}

TEST(SpscRing, fills_a_slot_in_place_and_not_where_it_is_full) {
    SpscRing<std::array<int, 2>> ring(1);
    const auto write_first = [](std::array<int, 2>& slot) { slot[0] = 7; };
    EXPECT_TRUE(ring.push({1, 2}));
    EXPECT_FALSE(ring.fill([](std::array<int, 2>&) { FAIL() << "a full ring has no slot"; }));
    EXPECT_EQ(ring.dropped(), 1U);
    std::array<int, 2> value{};
    EXPECT_TRUE(ring.pop(value));
    EXPECT_TRUE(ring.fill(write_first));
    EXPECT_TRUE(ring.pop(value));
    EXPECT_EQ(value, (std::array{7, 2}));
}

TEST(SpscRing, carries_every_value_whole_between_threads) {
    using Record = std::array<std::uint64_t, 20>;
    constexpr std::uint64_t count = 1 << 17;
    SpscRing<Record> ring(64);
    std::thread producer([&] {
        for (std::uint64_t i = 0; i < count;) {
            Record record;
            record.fill(i);
            if (ring.push(record))
                ++i;
            else
                std::this_thread::yield();
        }
    });
    bool right = true;
    for (std::uint64_t i = 0; i < count;) {
        Record record;
        if (!ring.pop(record)) {
            std::this_thread::yield();
            continue;
        }
        for (const std::uint64_t word : record) right = right && word == i;
        ++i;
    }
    producer.join();
    EXPECT_TRUE(right);
}

}  // namespace
}  // namespace palpate
