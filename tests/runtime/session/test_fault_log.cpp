// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "runtime/session/watch/fault_log.hpp"

namespace palpate {
namespace {

using namespace session;

// Ticks of two tools, the first of which has `first`, the second `second` as faults.
void add(FaultLog& log, int ticks, std::int64_t& tick, std::uint32_t first, std::uint32_t second) {
    for (int i = 0; i < ticks; ++i, ++tick)
        for (const std::int32_t tool : {0, 1}) {
            TickResult result{};
            result.tick = tick;
            result.tool = tool;
            result.time = 1e-3 * static_cast<double>(tick);
            result.faults = tool == 0 ? first : second;
            log.add(result);
        }
}

TEST(FaultLog, each_fault_is_told_of_once_with_its_cause) {
    std::vector<std::string> told;
    FaultLog log([&](const FaultEvent& event) { told.push_back(fault_sentence(event)); });
    std::int64_t tick = 0;
    add(log, 100, tick, no_fault, no_fault);
    add(log, 50, tick, no_fault, device_lost);
    add(log, 2000, tick, no_fault, no_fault);
    add(log, 1, tick, tick_late, tick_late);
    add(log, 10, tick, servo_stopping, servo_stopping);
    ASSERT_EQ(told.size(), 2U);
    EXPECT_EQ(told[0].find("0.100 s, tool 2: the device no longer answers (device_lost)"), 0U) << told[0];
    EXPECT_EQ(told[1].find("2.150 s: the servo stood still (tick_late)"), 0U) << told[1];
    EXPECT_EQ(log.events()[0].tool, 1);
    EXPECT_NEAR(log.events()[0].until, 0.149, 1e-9);
    EXPECT_EQ(log.events()[1].tool, -1);
}

TEST(FaultLog, one_that_comes_again_before_the_force_is_back_is_the_same_one) {
    FaultLog log;
    std::int64_t tick = 0;
    for (int i = 0; i < 10; ++i) {
        add(log, 1, tick, motors_warm, no_fault);
        add(log, 300, tick, no_fault, no_fault);
    }
    EXPECT_EQ(log.events().size(), 1U);
    add(log, 600, tick, no_fault, no_fault);
    add(log, 1, tick, motors_warm, no_fault);
    EXPECT_EQ(log.events().size(), 2U);
}

TEST(FaultLog, every_fault_has_a_name_a_cause_and_a_way_out) {
    std::uint32_t all = 0;
    for (const FaultText& text : fault_texts()) {
        EXPECT_EQ(text.fault & all, 0U) << text.name;
        all |= text.fault;
        EXPECT_EQ(fault_names(text.fault), text.name);
        EXPECT_EQ(std::string(text.remedy).size() > 10, text.fault != servo_stopping) << text.name;
    }
    EXPECT_EQ(all, (1U << fault_texts().size()) - 1);
}

}  // namespace
}  // namespace palpate
