// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <limits>

#include "formats/records/tick_result.hpp"
#include "runtime/haptics/force_limiter.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;

const HapticSettings settings{
    .tool_radius = 1, .coupling_stiffness = 0.5, .max_force = 3, .max_force_rate = 0.5};
constexpr double limiter_rounding = 1e-12;

Vector3d next(ForceLimiter& limiter, const Vector3d& wanted, std::uint32_t faults = no_fault) {
    std::uint32_t status = tick_ok;
    return limiter.limit(wanted, faults, status);
}

TEST(ForceLimiter, passes_small_slow_forces) {
    ForceLimiter limiter(settings);
    std::uint32_t status = tick_ok, faults = no_fault;
    EXPECT_EQ(limiter.limit({0.3, 0, 0}, faults, status), Vector3d(0.3, 0, 0));
    EXPECT_EQ(limiter.limit({0.3, 0.4, 0}, faults, status), Vector3d(0.3, 0.4, 0));
    EXPECT_EQ(status, tick_ok);
    EXPECT_EQ(faults, no_fault);
}

TEST(ForceLimiter, reaches_max_force_in_steps_and_no_more) {
    ForceLimiter limiter(settings);
    Vector3d last = Vector3d::Zero();
    for (int tick = 0; tick < 20; ++tick) {
        std::uint32_t status = tick_ok, faults = no_fault;
        const Vector3d force = limiter.limit({0, 0, 100}, faults, status);
        EXPECT_LE((force - last).norm(), settings.max_force_rate + limiter_rounding);
        EXPECT_TRUE(status & force_limited);
        EXPECT_EQ((status & rate_limited) != 0, tick < 5) << tick;
        last = force;
    }
    EXPECT_NEAR((last - Vector3d(0, 0, 3)).norm(), 0, limiter_rounding);
}

TEST(ForceLimiter, no_force_is_larger_than_its_rate_takes_away_in_time) {
    HapticSettings gentle = settings;
    gentle.max_force_rate = 0.01;
    ForceLimiter limiter(gentle);
    Vector3d last = Vector3d::Zero();
    for (int tick = 0; tick < 100; ++tick) last = next(limiter, {3, 0, 0});
    EXPECT_NEAR(last.norm(), 0.01 * ForceLimiter::ramp_ticks, limiter_rounding);
    for (int tick = 0; tick < ForceLimiter::ramp_ticks; ++tick) {
        const Vector3d force = next(limiter, {3, 0, 0}, device_lost);
        EXPECT_LE((force - last).norm(), 0.01 + limiter_rounding);
        last = force;
    }
    EXPECT_NEAR(last.norm(), 0, limiter_rounding);
}

TEST(ForceLimiter, ramps_to_zero_in_time_after_a_force_that_is_not_a_number) {
    ForceLimiter limiter(settings);
    for (int tick = 0; tick < 10; ++tick) next(limiter, {3, 0, 0});
    double last = 3;
    for (int tick = 0; tick < ForceLimiter::ramp_ticks; ++tick) {
        std::uint32_t status = tick_ok, faults = no_fault;
        const Vector3d force =
            limiter.limit({std::numeric_limits<double>::quiet_NaN(), 0, 0}, faults, status);
        EXPECT_EQ(faults, invalid_force);
        EXPECT_LE(force.norm(), last);
        EXPECT_GE(force.norm(), last - settings.max_force / ForceLimiter::ramp_ticks - limiter_rounding);
        last = force.norm();
    }
    EXPECT_NEAR(last, 0, limiter_rounding);
}

TEST(ForceLimiter, a_small_force_goes_in_as_many_steps_as_a_large_one) {
    ForceLimiter limiter(settings);
    constexpr double small = 0.1;
    for (int tick = 0; tick < 10; ++tick) next(limiter, {0, small, 0});
    for (int left = ForceLimiter::ramp_ticks - 1; left >= 0; --left) {
        const Vector3d force = next(limiter, {0, small, 0}, tick_late);
        EXPECT_NEAR((force - Vector3d(0, small * left / ForceLimiter::ramp_ticks, 0)).norm(), 0,
                    limiter_rounding);
    }
}

TEST(ForceLimiter, a_fault_of_one_tick_still_ends_in_zero_force) {
    ForceLimiter limiter(settings);
    for (int tick = 0; tick < 10; ++tick) next(limiter, {3, 0, 0});
    next(limiter, {3, 0, 0}, tick_late);
    for (int tick = 0; tick < ForceLimiter::ramp_ticks - 2; ++tick)
        EXPECT_GT(next(limiter, {3, 0, 0}).norm(), 0);
    EXPECT_NEAR(next(limiter, {3, 0, 0}).norm(), 0, limiter_rounding);
}

TEST(ForceLimiter, after_a_fault_the_force_returns_without_a_kick) {
    ForceLimiter limiter(settings);
    for (int tick = 0; tick < 10; ++tick) next(limiter, {3, 0, 0});
    for (int tick = 0; tick < 40; ++tick) next(limiter, {3, 0, 0}, device_lost);
    double last = 0;
    const int back = ForceLimiter::ramp_ticks + ForceLimiter::return_ticks;
    for (int tick = 1; tick <= back; ++tick) {
        std::uint32_t status = tick_ok, faults = no_fault;
        // A hand that pressed on meanwhile: far more than the limit is wanted.
        const double force = limiter.limit({30, 0, 0}, faults, status).norm();
        EXPECT_LE(force - last, settings.max_force / ForceLimiter::return_ticks + limiter_rounding) << tick;
        EXPECT_EQ((status & coming_back) != 0, tick < back);
        last = force;
    }
    EXPECT_NEAR(last, 3, limiter_rounding);
}

}  // namespace
}  // namespace palpate
