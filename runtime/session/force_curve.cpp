// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/force_curve.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace palpate {
namespace {

constexpr double width = 960, height = 420, left = 70, right = 70, top = 44, bottom = 56;

struct Axis {
    double end = 1;   // the axis runs from 0 to here
    double step = 1;  // between ticks
};

// About `ticks` steps of 1, 2 or 5 times a power of ten up to `largest`.
Axis axis_up_to(double largest, double ticks) {
    if (!(largest > 0)) return {};
    const double power = std::pow(10, std::floor(std::log10(largest / ticks)));
    double step = 10 * power;
    for (const double factor : {1.0, 2.0, 5.0})
        if (largest / (factor * power) <= ticks) {
            step = factor * power;
            break;
        }
    return {step * std::ceil(largest / step - 1e-9), step};
}

double x_of(double time, const Axis& axis) {
    return left + time / axis.end * (width - left - right);
}

double y_of(double value, const Axis& axis) {
    return height - bottom - value / axis.end * (height - top - bottom);
}

std::string text(double x, double y, const char* anchor, const std::string& content, const char* fill,
                 const char* extra = "") {
    return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}" fill="{}"{}>{}</text>)"
                       "\n",
                       x, y, anchor, fill, extra, content);
}

// Joins the values; within one pixel column only its lowest and highest are kept.
template <typename Value>
std::string line(const std::vector<CurvePoint>& points, const Axis& time, const Axis& axis, Value value,
                 const char* colour) {
    std::string path;
    for (std::size_t i = 0; i < points.size();) {
        const double column = std::floor(x_of(points[i].time, time));
        std::size_t low = i, high = i;
        for (; i < points.size() && std::floor(x_of(points[i].time, time)) == column; ++i) {
            if (value(points[i]) < value(points[low])) low = i;
            if (value(points[i]) > value(points[high])) high = i;
        }
        for (const std::size_t k : {std::min(low, high), std::max(low, high)})
            path += fmt::format("{:.2f},{:.2f} ", x_of(points[k].time, time), y_of(value(points[k]), axis));
    }
    return fmt::format(R"(<polyline fill="none" stroke="{}" stroke-width="1.6" points="{}"/>)"
                       "\n",
                       colour, path);
}

std::string escaped(const std::string& plain) {
    std::string result;
    for (const char c : plain)
        result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
    return result;
}

}  // namespace

std::string force_curve_svg(const std::vector<CurvePoint>& points, const std::string& title) {
    constexpr auto force_of = [](const CurvePoint& p) { return p.force; };
    constexpr auto depth_of = [](const CurvePoint& p) { return p.depth; };
    constexpr auto force_colour = "#b2182b", depth_colour = "#2166ac", ink = "#333333", grid = "#dddddd";
    double largest_force = 0, largest_depth = 0, largest_time = 0;
    for (const CurvePoint& p : points) {
        largest_force = std::max(largest_force, p.force);
        largest_depth = std::max(largest_depth, p.depth);
        largest_time = std::max(largest_time, p.time);
    }
    const Axis time = axis_up_to(largest_time, 10), force = axis_up_to(largest_force, 6),
               depth = axis_up_to(largest_depth, 6);

    std::string svg = fmt::format(
        R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" font-family="sans-serif" font-size="13">)"
        "\n"
        R"(<rect width="{0}" height="{1}" fill="white"/>)"
        "\n",
        width, height);
    svg += text(width / 2, 24, "middle", escaped(title), ink, R"( font-size="15")");
    const auto rule = [&](double x1, double y1, double x2, double y2, const char* colour) {
        svg += fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" stroke="{}"/>)"
                           "\n",
                           x1, y1, x2, y2, colour);
    };
    const double half_step = 0.5;
    for (double t = 0; t <= time.end + half_step * time.step; t += time.step) {
        rule(x_of(t, time), top, x_of(t, time), height - bottom, grid);
        svg += text(x_of(t, time), height - bottom + 18, "middle", fmt::format("{:.4g}", t), ink);
    }
    for (double f = 0; f <= force.end + half_step * force.step; f += force.step) {
        rule(left, y_of(f, force), width - right, y_of(f, force), grid);
        svg += text(left - 8, y_of(f, force) + 4, "end", fmt::format("{:.4g}", f), force_colour);
    }
    for (double d = 0; d <= depth.end + half_step * depth.step; d += depth.step)
        svg += text(width - right + 8, y_of(d, depth) + 4, "start", fmt::format("{:.4g}", d), depth_colour);
    rule(left, height - bottom, width - right, height - bottom, ink);
    svg += text(width / 2, height - 14, "middle", "time (s)", ink);
    const double middle = (top + height - bottom) / 2;
    svg += text(20, middle, "middle", "force (N)", force_colour,
                fmt::format(R"svg( transform="rotate(-90 20 {:.1f})")svg", middle).c_str());
    svg += text(width - 16, middle, "middle", "depth below the rest surface (mm)", depth_colour,
                fmt::format(R"svg( transform="rotate(90 {:.1f} {:.1f})")svg", width - 16, middle).c_str());
    svg += line(points, time, depth, depth_of, depth_colour);
    svg += line(points, time, force, force_of, force_colour);
    return svg + "</svg>\n";
}

}  // namespace palpate
