// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <string>

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

TEST(ForceCurve, draws_nothing_felt_as_a_flat_line) {
    EXPECT_NE(force_curve_svg({}, "none").find("</svg>"), std::string::npos);
    const std::string flat = force_curve_svg({{0, 0, 0}, {1, 0, 0}}, "none");
    EXPECT_EQ(flat.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace palpate
