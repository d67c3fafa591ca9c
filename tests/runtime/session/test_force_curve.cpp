// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "runtime/session/force_curve.hpp"

namespace palpate {
namespace {

using namespace session;

std::vector<CurvePoint> one_press() {
    std::vector<CurvePoint> points;
    for (int i = 0; i < 10000; ++i) {
        const double wave = std::abs(std::sin(1e-3 * i));
        points.push_back({1e-3 * i, wave, 3 * wave});
    }
    points[5000].force = 2.4;  // a peak of a single tick
    return points;
}

TEST(ForceCurve, labels_axes_with_units_and_keeps_a_peak_of_one_tick) {
    const std::string svg = force_curve_svg(one_press(), "liver & <press>");
    for (const char* part : {"<svg ", "force (N)", "time (s)", "depth below the rest surface (mm)",
                             "liver &amp; &lt;press&gt;", "</svg>"})
        EXPECT_NE(svg.find(part), std::string::npos) << part;
    // The axis runs to 2.5 N over 328 pixels; the peak is drawn at 40 + 328 * 0.1 / 2.5.
    EXPECT_NE(svg.find(",53.12 "), std::string::npos);
    EXPECT_LT(svg.size(), 100000U);
}

TEST(ForceCurve, of_a_short_run_keeps_every_tick) {
    const std::vector<CurvePoint> press = one_press();
    for (const std::size_t ticks : {1U, 2U, 7U, 10000U}) {
        ForceCurve curve;
        for (std::size_t n = 0; n < ticks; ++n) curve.add(press[n]);
        const std::vector<CurvePoint> points = curve.points();
        ASSERT_EQ(points.size(), ticks);
        for (std::size_t n = 0; n < ticks; ++n) ASSERT_EQ(points[n].time, press[n].time);
    }
}

TEST(ForceCurve, of_hours_stays_small_and_keeps_peaks_and_gaps_of_one_tick_in_order) {
    constexpr std::int64_t ticks = 3'600'000, peak = 1'234'567, gap = 2'345'678;
    ForceCurve curve;
    for (std::int64_t tick = 0; tick < ticks; ++tick) {
        const double force = tick == peak ? 3 : tick == gap ? 0 : 1;
        curve.add({1e-3 * static_cast<double>(tick), force, force});
    }
    const std::vector<CurvePoint> points = curve.points();
    EXPECT_LE(points.size(), ForceCurve::most_points);
    EXPECT_GT(points.size(), ForceCurve::most_points / 4);
    EXPECT_EQ(points.front().time, 0);
    EXPECT_NEAR(points.back().time, 1e-3 * (ticks - 1), 0.2);
    for (const auto& [tick, force] : {std::pair{peak, 3.0}, std::pair{gap, 0.0}}) {
        const auto found = std::ranges::find(points, force, &CurvePoint::force);
        ASSERT_NE(found, points.end());
        EXPECT_EQ(found->time, 1e-3 * static_cast<double>(tick));
    }
    EXPECT_TRUE(std::ranges::is_sorted(points, {}, &CurvePoint::time));
}

// Times of a recording are whatever its file says.
TEST(ForceCurve, of_times_that_stand_still_or_go_back_or_are_none_stays_small_too) {
    for (const double step : {0.0, -1e-3, std::numeric_limits<double>::quiet_NaN()})
        for (const double force : {1.0, std::numeric_limits<double>::quiet_NaN()}) {
            ForceCurve curve;
            constexpr std::size_t ticks = 3 * ForceCurve::most_points + 1;
            for (std::size_t n = 0; n < ticks; ++n) curve.add({step * static_cast<double>(n), force, 0});
            EXPECT_LE(curve.points().size(), ForceCurve::most_points);
            EXPECT_GT(curve.points().size(), ForceCurve::most_points / 4);
        }
}

TEST(ForceCurve, draws_nothing_felt_as_a_flat_line) {
    EXPECT_NE(force_curve_svg({}, "none").find("</svg>"), std::string::npos);
    const std::string flat = force_curve_svg({{0, 0, 0}, {1, 0, 0}}, "none");
    EXPECT_EQ(flat.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace palpate
