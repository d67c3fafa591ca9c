// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>

#include "runtime/training/metrics.hpp"

namespace palpate {
namespace {

using namespace training;
using Eigen::Vector3d;

std::vector<Sample> sampled(double seconds, const std::function<Vector3d(double)>& position) {
    std::vector<Sample> samples;
    const auto count = static_cast<int>(std::lround(seconds / sample_period)) + 1;
    for (int i = 0; i < count; ++i)
        samples.push_back(
            {.time = i * sample_period, .position = position(i * sample_period), .force = 0, .depth = 0});
    return samples;
}

// A reach of `length` mm in `duration` s (Flash and Hogan 1985).
double minimum_jerk(double length, double time, double duration) {
    const double s = std::clamp(time / duration, 0.0, 1.0);
    return length * (10 * s * s * s - 15 * s * s * s * s + 6 * s * s * s * s * s);
}

const Vector3d way = Vector3d(1, 2, 2) / 3;

TEST(Metrics, path_length_of_a_reach_is_its_length) {
    const auto reach = sampled(2, [](double t) { return Vector3d(way * minimum_jerk(80, t, 2)); });
    EXPECT_NEAR(path_length(reach), 80, 1e-9);
}

TEST(Metrics, jerk_of_a_minimum_jerk_reach_is_the_theorys_at_any_size_and_duration) {
    // integral of x'''^2 = 720, v_peak = 15/8: -ln(720 / (15/8)^2)
    const double theory = -std::log(720 / (15.0 / 8 * 15.0 / 8));
    for (const double duration : {1.0, 4.0})
        for (const double length : {10.0, 200.0}) {
            const auto reach = sampled(
                duration, [&](double t) { return Vector3d(way * minimum_jerk(length, t, duration)); });
            EXPECT_NEAR(log_dimensionless_jerk(reach), theory, 0.1) << duration << " s, " << length << " mm";
        }
}

// Values of the published Python code of the same paper for the same speeds.
TEST(Metrics, spectral_arc_length_is_that_of_the_published_code) {
    const auto once = sampled(1, [](double t) { return Vector3d(way * minimum_jerk(100, t, 1)); });
    EXPECT_NEAR(spectral_arc_length(once), -1.405845851605, 1e-9);
    const auto twice = sampled(
        2, [](double t) { return Vector3d(way * (minimum_jerk(100, t, 1) + minimum_jerk(100, t - 1, 1))); });
    EXPECT_NEAR(spectral_arc_length(twice), -2.2444559866093, 1e-9);
}

TEST(Metrics, a_hand_that_stops_on_its_way_is_less_smooth) {
    const auto smooth = sampled(3, [](double t) { return Vector3d(way * minimum_jerk(90, t, 3)); });
    const auto halting = sampled(3, [](double t) {
        double x = 0;
        for (int i = 0; i < 3; ++i) x += minimum_jerk(30, t - i, 1);
        return Vector3d(way * x);
    });
    EXPECT_LT(log_dimensionless_jerk(halting), log_dimensionless_jerk(smooth));
    EXPECT_LT(spectral_arc_length(halting), spectral_arc_length(smooth));
}

TEST(Metrics, tremor_is_the_root_mean_square_of_a_vibration_in_the_band) {
    const auto trembling = [](double frequency) {
        return sampled(10, [=](double t) {
            return Vector3d(way * (5 * t) +
                            Vector3d::UnitX() * std::sin(2 * std::numbers::pi * frequency * t));
        });
    };
    EXPECT_NEAR(tremor(trembling(9)), 1 / std::numbers::sqrt2, 0.02);
    EXPECT_LT(tremor(trembling(2)), 0.02);
    EXPECT_LT(tremor(trembling(20)), 0.02);
}

TEST(Metrics, a_hand_at_rest_has_no_smoothness) {
    const auto rest = sampled(2, [](double) { return Vector3d(1, 2, 3); });
    EXPECT_TRUE(std::isnan(log_dimensionless_jerk(rest)));
    EXPECT_TRUE(std::isnan(spectral_arc_length(rest)));
    EXPECT_EQ(path_length(rest), 0);
    EXPECT_TRUE(std::isnan(tremor(std::vector<Sample>(rest.begin(), rest.begin() + 50))));
}

}  // namespace
}  // namespace palpate
