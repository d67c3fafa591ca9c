// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <limits>

#include "runtime/haptics/force_limiter.hpp"
#include "runtime/haptics/tick_result.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

const HapticSettings settings{
    .tool_radius = 1, .coupling_stiffness = 0.5, .max_force = 3, .max_force_rate = 0.5};
constexpr double rounding = 1e-12;

TEST(ForceLimiter, passes_small_slow_forces) {
    ForceLimiter limiter(settings);
    std::uint32_t status = tick_ok;
    EXPECT_EQ(limiter.limit({0.3, 0, 0}, status), Vector3d(0.3, 0, 0));
    EXPECT_EQ(limiter.limit({0.3, 0.4, 0}, status), Vector3d(0.3, 0.4, 0));
    EXPECT_EQ(status, tick_ok);
}

TEST(ForceLimiter, reaches_max_force_in_steps_and_no_more) {
    ForceLimiter limiter(settings);
    Vector3d last = Vector3d::Zero();
    for (int tick = 0; tick < 20; ++tick) {
        std::uint32_t status = tick_ok;
        const Vector3d force = limiter.limit({0, 0, 100}, status);
        EXPECT_LE((force - last).norm(), settings.max_force_rate + rounding);
        EXPECT_TRUE(status & force_limited);
        EXPECT_EQ((status & rate_limited) != 0, tick < 5) << tick;
        last = force;
    }
    EXPECT_NEAR((last - Vector3d(0, 0, 3)).norm(), 0, rounding);
}

TEST(ForceLimiter, ramps_to_zero_within_20_ticks_of_a_fault) {
    ForceLimiter limiter(settings);
    std::uint32_t status = tick_ok;
    for (int tick = 0; tick < 10; ++tick) limiter.limit({3, 0, 0}, status);
    double last = 3;
    for (int tick = 0; tick < 20; ++tick) {
        status = tick_ok;
        const Vector3d force = limiter.limit({std::numeric_limits<double>::quiet_NaN(), 0, 0}, status);
        EXPECT_TRUE(status & invalid_position);
        EXPECT_LE(force.norm(), last);
        EXPECT_GE(force.norm(), last - settings.max_force / 20 - rounding);
        last = force.norm();
    }
    EXPECT_NEAR(last, 0, rounding);
}

}  // namespace
}  // namespace palpate
