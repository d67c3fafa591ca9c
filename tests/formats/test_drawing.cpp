// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <string>

#include "formats/drawing/axis.hpp"
#include "formats/drawing/chart.hpp"
#include "formats/drawing/markup.hpp"

namespace palpate::drawing {
namespace {

using Ticks = std::vector<double>;

int count_of(const std::string& part, const std::string& text) {
    int count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

TEST(Escaped, replaces_what_has_a_meaning) {
    EXPECT_EQ(escaped("<a href=\"x\">'&'</a>"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
}

TEST(Axis, has_steps_of_1_2_or_5_and_begins_at_zero_unless_values_are_far_from_it) {
    EXPECT_EQ(axis_between(0, 2.4, false, 6).ticks, (Ticks{0, 0.5, 1, 1.5, 2, 2.5}));
    EXPECT_EQ(axis_between(3, 10, false, 6).ticks, (Ticks{0, 2, 4, 6, 8, 10}));
    EXPECT_EQ(axis_between(100, 103, false, 6).ticks, (Ticks{100, 100.5, 101, 101.5, 102, 102.5, 103}));
    EXPECT_EQ(axis_between(-7, -1, false, 6).ticks, (Ticks{-8, -6, -4, -2, 0}));
    EXPECT_EQ(axis_between(0, 0, false, 6).ticks.size(), 6U);
}

TEST(Axis, of_decades_fills_two_of_them_with_2_and_5_and_leaves_some_out_of_many) {
    EXPECT_EQ(axis_between(3, 70, true, 6).ticks, (Ticks{1, 2, 5, 10, 20, 50, 100}));
    EXPECT_EQ(axis_between(1, 1000, true, 6).ticks, (Ticks{1, 10, 100, 1000}));
    EXPECT_LE(axis_between(1e-9, 1e9, true, 6).ticks.size(), 9U);
    EXPECT_DOUBLE_EQ(axis_between(1, 1000, true, 6).place(10), 1.0 / 3);
}

TEST(ChartsSvg, a_peak_of_one_point_among_many_is_drawn_and_the_rest_of_its_column_is_not) {
    Series series{.name = "noise"};
    for (int i = 0; i < 100'000; ++i) {
        series.x.push_back(i);
        series.y.push_back(i == 33'333 ? 4 : 1e-3 * (i % 7));
    }
    const std::string svg = charts_svg({{.title = "t", .x_label = "x", .y_label = "y", .series = {series}}});
    // The axis runs to 4, which is the plot's top.
    EXPECT_EQ(count_of(",40.00 ", svg), 1);
    EXPECT_LT(svg.size(), 50'000U);
}

TEST(ChartsSvg, what_cannot_be_drawn_interrupts_a_line) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    Chart chart{.title = "t", .x_label = "x", .y_label = "y"};
    chart.series.push_back({.name = "gap", .x = {1, 2, 3, 4, 5}, .y = {1, 2, nan, 4, 5}});
    const auto lines = [&] { return count_of("<polyline", charts_svg({chart})); };
    EXPECT_EQ(lines(), 2 + 1);  // the last in the legend
    chart.series[0].y = {1, 2, 0, 4, 5};
    EXPECT_EQ(lines(), 1 + 1);
    chart.log_y = true;
    EXPECT_EQ(lines(), 2 + 1);
    EXPECT_EQ(charts_svg({chart}).find("nan"), std::string::npos);
}

TEST(ChartsSvg, a_legend_names_each_series_and_markers_of_one_pixel_are_one) {
    Chart chart{.title = "a < b", .x_label = "x", .y_label = "y"};
    chart.series.push_back({.name = "cloud", .x = {1, 1, 2}, .y = {1, 1, 2}, .markers = true});
    const std::string svg = charts_svg({chart, chart});
    EXPECT_EQ(count_of("<circle", svg), 2 * (2 + 1));
    EXPECT_EQ(count_of(">cloud<", svg), 2);
    EXPECT_EQ(count_of("a &lt; b", svg), 2);
    EXPECT_NE(svg.find(R"(viewBox="0 0 960 720")"), std::string::npos);
}

TEST(ChartsSvg, a_right_axis_has_its_own_scale_and_the_colour_of_its_series_in_place_of_a_legend) {
    const std::string svg =
        charts_svg({{.title = "t",
                     .x_label = "x",
                     .y_label = "left",
                     .series = {{.name = "a", .x = {0, 10}, .y = {0, 1}},
                                {.name = "b", .x = {0, 10}, .y = {0, 5000}, .right = true}},
                     .right_label = "right"}});
    // Both end at the plot's upper right corner.
    EXPECT_EQ(count_of("880.00,40.00", svg), 2);
    EXPECT_NE(svg.find(R"(fill="#b2182b">5000<)"), std::string::npos);
    EXPECT_NE(svg.find(R"(fill="#2166ac">0.2<)"), std::string::npos);
    EXPECT_EQ(svg.find(">a<"), std::string::npos);
}

TEST(ChartsSvg, nothing_is_drawn_as_an_empty_chart) {
    for (const bool log : {false, true}) {
        const Chart chart{.title = "t", .x_label = "x", .y_label = "y", .log_x = log, .log_y = log};
        const std::string svg = charts_svg({chart});
        EXPECT_EQ(svg.find("nan"), std::string::npos);
        EXPECT_NE(svg.find("</svg>"), std::string::npos);
    }
}

}  // namespace
}  // namespace palpate::drawing
