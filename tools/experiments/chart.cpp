// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <set>
#include <utility>

namespace palpate::bench {
namespace {

constexpr double width = 960, height = 360, left = 80, right = 230, top = 40, bottom = 52;
constexpr auto ink = "#333333", grid = "#dddddd";
constexpr std::array colours{"#2166ac", "#b2182b", "#1b7837", "#e08214",
                             "#762a83", "#35978f", "#8c510a", "#333333"};

// Where values lie between the ends of an axis, and which of them get a tick.
struct Axis {
    bool log = false;
    double begin = 0, end = 1;  // in the scaled value
    std::vector<double> ticks;  // values

    double scaled(double value) const { return log ? std::log10(value) : value; }
    double place(double value) const { return (scaled(value) - begin) / (end - begin); }
};

bool is_drawable(double value, bool log) {
    return std::isfinite(value) && (!log || value > 0);
}

// Whole decades; where there are but two, 2 and 5 times each as well.
Axis log_axis(double low, double high) {
    Axis axis{
        .log = true, .begin = std::floor(std::log10(low)), .end = std::ceil(std::log10(high)), .ticks = {}};
    if (axis.begin == axis.end) ++axis.end;
    const double stride = std::ceil((axis.end - axis.begin) / 8);
    for (double decade = axis.begin; decade <= axis.end; decade += stride)
        for (const double factor : {1.0, 2.0, 5.0})
            if (factor == 1 || (axis.end - axis.begin <= 2 && decade < axis.end))
                axis.ticks.push_back(factor * std::pow(10, decade));
    return axis;
}

// At most `count` steps of 1, 2 or 5 times a power of ten. Values far from zero do not drag it in.
Axis linear_axis(double low, double high, double count) {
    if (low > 0 && low < 0.5 * high) low = 0;
    if (high < 0 && high > 0.5 * low) high = 0;
    if (!(high > low)) high = low + std::max(1.0, std::abs(low));
    const double power = std::pow(10, std::floor(std::log10((high - low) / count)));
    double step = 10 * power;
    for (const double factor : {5.0, 2.0, 1.0})
        if ((high - low) / (factor * power) <= count) step = factor * power;
    const double first = std::floor(low / step + 1e-9), last = std::ceil(high / step - 1e-9);
    Axis axis{.log = false, .begin = first * step, .end = last * step, .ticks = {}};
    for (double k = first; k <= last; ++k) axis.ticks.push_back(k * step);
    return axis;
}

Axis axis_over(const Chart& chart, std::vector<double> Series::*values, bool log, double count) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Series& series : chart.series)
        for (const double value : series.*values)
            if (is_drawable(value, log)) {
                low = std::min(low, value);
                high = std::max(high, value);
            }
    if (low > high) return log ? log_axis(1, 10) : linear_axis(0, 1, count);
    return log ? log_axis(low, high) : linear_axis(low, high, count);
}

std::string escaped(const std::string& plain) {
    std::string result;
    for (const char c : plain)
        result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
    return result;
}

std::string text(double x, double y, const char* anchor, const std::string& content,
                 const std::string& attributes = "") {
    return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}" fill="{}"{}>{}</text>)"
                       "\n",
                       x, y, anchor, ink, attributes, escaped(content));
}

std::string rule(double x1, double y1, double x2, double y2, const char* colour) {
    return fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" stroke="{}"/>)"
                       "\n",
                       x1, y1, x2, y2, colour);
}

struct Pixel {
    double x, y;
};

// Lines are interrupted where a value cannot be drawn; within one pixel column only the lowest and the
// highest point of the way through it are kept.
std::string line(const std::vector<std::vector<Pixel>>& runs, const char* colour) {
    std::string svg;
    for (const std::vector<Pixel>& run : runs) {
        std::string path;
        for (std::size_t i = 0; i < run.size();) {
            const double column = std::floor(run[i].x);
            std::size_t low = i, high = i;
            for (; i < run.size() && std::floor(run[i].x) == column; ++i) {
                if (run[i].y < run[low].y) low = i;
                if (run[i].y > run[high].y) high = i;
            }
            path += fmt::format("{:.2f},{:.2f} ", run[std::min(low, high)].x, run[std::min(low, high)].y);
            if (low != high)
                path += fmt::format("{:.2f},{:.2f} ", run[std::max(low, high)].x, run[std::max(low, high)].y);
        }
        svg += fmt::format(R"(<polyline fill="none" stroke="{}" stroke-width="1.6" points="{}"/>)"
                           "\n",
                           colour, path);
    }
    return svg;
}

std::string markers(const std::vector<std::vector<Pixel>>& runs, const char* colour) {
    std::string svg;
    std::set<std::pair<double, double>> taken;
    for (const std::vector<Pixel>& run : runs)
        for (const Pixel& p : run)
            if (taken.emplace(std::floor(p.x), std::floor(p.y)).second)
                svg += fmt::format(R"(<circle cx="{:.2f}" cy="{:.2f}" r="3" fill="{}"/>)"
                                   "\n",
                                   p.x, p.y, colour);
    return svg;
}

std::string chart_svg(const Chart& chart, double above) {
    const double begin_x = left, end_x = width - right, begin_y = above + height - bottom,
                 end_y = above + top;
    const Axis axis_x = axis_over(chart, &Series::x, chart.log_x, 8),
               axis_y = axis_over(chart, &Series::y, chart.log_y, 6);
    const auto x_of = [&](double value) { return begin_x + axis_x.place(value) * (end_x - begin_x); };
    const auto y_of = [&](double value) { return begin_y + axis_y.place(value) * (end_y - begin_y); };

    std::string svg = text((begin_x + end_x) / 2, above + 24, "middle", chart.title, R"( font-size="15")");
    for (const double tick : axis_x.ticks) {
        svg += rule(x_of(tick), begin_y, x_of(tick), end_y, grid);
        svg += text(x_of(tick), begin_y + 18, "middle", fmt::format("{:.4g}", tick));
    }
    for (const double tick : axis_y.ticks) {
        svg += rule(begin_x, y_of(tick), end_x, y_of(tick), grid);
        svg += text(begin_x - 8, y_of(tick) + 4, "end", fmt::format("{:.4g}", tick));
    }
    svg += rule(begin_x, begin_y, end_x, begin_y, ink) + rule(begin_x, begin_y, begin_x, end_y, ink);
    svg += text((begin_x + end_x) / 2, begin_y + 40, "middle", chart.x_label);
    svg += text(20, (begin_y + end_y) / 2, "middle", chart.y_label,
                fmt::format(R"svg( transform="rotate(-90 20 {:.1f})")svg", (begin_y + end_y) / 2));

    for (std::size_t s = 0; s < chart.series.size(); ++s) {
        const Series& series = chart.series[s];
        const char* colour = colours[s % colours.size()];
        std::vector<std::vector<Pixel>> runs(1);
        for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i)
            if (is_drawable(series.x[i], chart.log_x) && is_drawable(series.y[i], chart.log_y))
                runs.back().push_back({x_of(series.x[i]), y_of(series.y[i])});
            else if (!runs.back().empty())
                runs.emplace_back();
        svg += series.markers ? markers(runs, colour) : line(runs, colour);

        const double legend_y = end_y + 10 + 20 * static_cast<double>(s);
        svg += series.markers ? markers({{{end_x + 28, legend_y}}}, colour)
                              : line({{{end_x + 16, legend_y}, {end_x + 40, legend_y}}}, colour);
        svg += text(end_x + 48, legend_y + 4, "start", series.name);
    }
    return svg;
}

}  // namespace

std::string charts_svg(const std::vector<Chart>& charts) {
    std::string svg = fmt::format(
        R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" font-family="sans-serif" font-size="13">)"
        "\n"
        R"(<rect width="{0}" height="{1}" fill="white"/>)"
        "\n",
        width, height * static_cast<double>(charts.size()));
    for (std::size_t c = 0; c < charts.size(); ++c)
        svg += chart_svg(charts[c], height * static_cast<double>(c));
    return svg + "</svg>\n";
}

}  // namespace palpate::bench
