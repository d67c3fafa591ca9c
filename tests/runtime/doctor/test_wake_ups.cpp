// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "runtime/doctor/wake_ups.hpp"
#include "tests/runtime/doctor/made_up_machine.hpp"

namespace palpate {
namespace {

using namespace doctor;

// 1000 wake-ups, of which `late` are late by `late_ns` and the others by 50 us.
WakeUps some(std::int64_t late_ns, int late, bool real_time = true) {
    WakeUps result;
    result.real_time = real_time;
    for (int i = 0; i < 1000; ++i) result.add(i < late ? late_ns : 50'000, 0);
    return result;
}

TEST(WakeUps, the_rate_held_is_the_highest_whose_period_fits_99_9_percent_and_the_tick) {
    EXPECT_EQ(rate_held(some(50'000, 0)), 1000);
    EXPECT_EQ(rate_held(some(800'000, 2)), 1000);
    EXPECT_EQ(rate_held(some(950'000, 2)), 500);
    EXPECT_EQ(rate_held(some(1'950'000, 2)), 250);
    EXPECT_EQ(rate_held(some(5'000'000, 2)), 0);
}

TEST(WakeUps, one_late_wake_up_in_a_thousand_is_forgiven) {
    EXPECT_EQ(rate_held(some(5'000'000, 1)), 1000);
}

TEST(WakeUps, deadlines_slept_through_count_with_their_wait) {
    WakeUps wake_ups;
    wake_ups.add(50'000, 0);
    wake_ups.add(3'500'000, 0);  // sleeps through the next three deadlines
    wake_ups.add(50'000, 3);
    EXPECT_EQ(wake_ups.missed, 3);
    EXPECT_EQ(wake_ups.late_ns.count(), 6U);
    EXPECT_EQ(wake_ups.late_ns.max(), 3'500'000U);
    // In order: 50 us twice, then 0.5, 1.5, 2.5 and 3.5 ms; a histogram's bound is up to 3 % above.
    EXPECT_NEAR(static_cast<double>(wake_ups.late_ns.percentile(0.5)), 500'000, 15'000);
    EXPECT_NEAR(static_cast<double>(wake_ups.late_ns.percentile(0.8)), 2'500'000, 75'000);
}

TEST(WakeUps, below_1000_hz_the_fix_depends_on_the_priority) {
    const auto rate = [](const WakeUps& servo, Purpose purpose) {
        return sample::find(wake_up_findings(servo, some(0, 0, false), purpose), "rate");
    };
    EXPECT_EQ(rate(some(50'000, 0), Purpose::device).level, Level::ok);
    const Finding with = rate(some(950'000, 2), Purpose::device);
    EXPECT_EQ(with.level, Level::warning);
    EXPECT_NE(with.fix.find("linux-image-rt-amd64"), std::string::npos);
    const Finding without = rate(some(950'000, 2, false), Purpose::device);
    EXPECT_NE(without.fix.find("permit SCHED_FIFO"), std::string::npos);
    EXPECT_EQ(rate(some(5'000'000, 2), Purpose::device).level, Level::problem);
    EXPECT_EQ(rate(some(5'000'000, 2), Purpose::simulation).level, Level::warning);
}

TEST(WakeUps, both_measurements_count_deadlines) {
    for (const WakeUps& wake_ups : {measure_servo(0.2), measure_without_priority(0.2)}) {
        EXPECT_GT(wake_ups.late_ns.count(), 0U);
        EXPECT_LT(wake_ups.missed, static_cast<std::int64_t>(wake_ups.late_ns.count()));
    }
    EXPECT_FALSE(measure_without_priority(0.1).real_time);
}

}  // namespace
}  // namespace palpate
