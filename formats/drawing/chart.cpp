// SPDX-License-Identifier: Apache-2.0
#include "formats/drawing/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <set>
#include <utility>

#include "formats/drawing/axis.hpp"
#include "formats/drawing/markup.hpp"

namespace palpate::drawing {
namespace {

constexpr double width = 960, left = 80, legend_width = 230, top = 40, bottom = 52, tick_width = 80;
constexpr auto ink = "#333333", grid = "#dddddd";
constexpr std::array colours{"#2166ac", "#b2182b", "#1b7837", "#e08214",
                             "#762a83", "#35978f", "#8c510a", "#333333"};

const char* colour_of(std::size_t series) {
    return colours[series % colours.size()];
}

struct Pixel {
    double x, y;
};
using Runs = std::vector<std::vector<Pixel>>;  // what a line joins without interruption

Axis axis_over(const Chart& chart, std::vector<double> Series::*values, bool right, bool log, double count) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Series& series : chart.series)
        for (const double value : series.*values)
            if ((values == &Series::x || series.right == right) && is_drawable(value, log)) {
                low = std::min(low, value);
                high = std::max(high, value);
            }
    return low <= high ? axis_between(low, high, log, count)
                       : axis_between(log ? 1 : 0, log ? 10 : 1, log, count);
}

std::string text(Pixel at, const char* anchor, const std::string& content, const char* colour = ink,
                 const std::string& attributes = "") {
    return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}" fill="{}"{}>{}</text>)"
                       "\n",
                       at.x, at.y, anchor, colour, attributes, escaped(content));
}

// Reads upwards, or downwards on the right side.
std::string upright_text(Pixel at, int degrees, const std::string& content, const char* colour) {
    return text(at, "middle", content, colour,
                fmt::format(R"svg( transform="rotate({} {} {:.1f})")svg", degrees, at.x, at.y));
}

std::string rule(Pixel from, Pixel to, const char* colour) {
    return fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" stroke="{}"/>)"
                       "\n",
                       from.x, from.y, to.x, to.y, colour);
}

// Within one pixel column only the lowest and the highest point of the way through it are kept.
std::string line(const Runs& runs, const char* colour) {
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
            for (const std::size_t k : std::set{low, high})
                path += fmt::format("{:.2f},{:.2f} ", run[k].x, run[k].y);
        }
        svg += fmt::format(R"(<polyline fill="none" stroke="{}" stroke-width="1.6" points="{}"/>)"
                           "\n",
                           colour, path);
    }
    return svg;
}

std::string markers(const Runs& runs, const char* colour) {
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
    const bool has_right = !chart.right_label.empty();
    const double begin_x = left, end_x = width - (has_right ? left : legend_width),
                 begin_y = above + chart.height - bottom, end_y = above + top;
    const double middle_x = (begin_x + end_x) / 2, middle_y = (begin_y + end_y) / 2;
    const Axis axis_x = axis_over(chart, &Series::x, false, chart.log_x,
                                  std::floor((end_x - begin_x) / tick_width)),
               axis_left = axis_over(chart, &Series::y, false, chart.log_y, 6),
               axis_right = axis_over(chart, &Series::y, true, false, 6);
    const auto x_of = [&](double value) { return begin_x + axis_x.place(value) * (end_x - begin_x); };
    const auto y_of = [&](double value, const Axis& axis) {
        return begin_y + axis.place(value) * (end_y - begin_y);
    };
    const auto axis_colour = [&](bool right) {
        const auto first = std::ranges::find(chart.series, right, &Series::right) - chart.series.begin();
        return has_right ? colour_of(static_cast<std::size_t>(first)) : ink;
    };

    std::string svg = text({middle_x, above + 24}, "middle", chart.title, ink, R"( font-size="15")");
    for (const double tick : axis_x.ticks) {
        svg += rule({x_of(tick), begin_y}, {x_of(tick), end_y}, grid);
        svg += text({x_of(tick), begin_y + 18}, "middle", fmt::format("{:.4g}", tick));
    }
    for (const double tick : axis_left.ticks) {
        const double y = y_of(tick, axis_left);
        svg += rule({begin_x, y}, {end_x, y}, grid);
        svg += text({begin_x - 8, y + 4}, "end", fmt::format("{:.4g}", tick), axis_colour(false));
    }
    svg += rule({begin_x, begin_y}, {end_x, begin_y}, ink) + rule({begin_x, begin_y}, {begin_x, end_y}, ink);
    svg += text({middle_x, begin_y + 40}, "middle", chart.x_label);
    svg += upright_text({20, middle_y}, -90, chart.y_label, axis_colour(false));
    if (has_right) {
        for (const double tick : axis_right.ticks)
            svg += text({end_x + 8, y_of(tick, axis_right) + 4}, "start", fmt::format("{:.4g}", tick),
                        axis_colour(true));
        svg += upright_text({width - 20, middle_y}, 90, chart.right_label, axis_colour(true));
    }

    for (std::size_t s = 0; s < chart.series.size(); ++s) {
        const Series& series = chart.series[s];
        const auto draw = series.markers ? markers : line;
        const bool log_y = chart.log_y && !series.right;
        Runs runs(1);
        for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i)
            if (is_drawable(series.x[i], chart.log_x) && is_drawable(series.y[i], log_y))
                runs.back().push_back(
                    {x_of(series.x[i]), y_of(series.y[i], series.right ? axis_right : axis_left)});
            else if (!runs.back().empty())
                runs.emplace_back();
        svg += draw(runs, colour_of(s));
        if (has_right) continue;

        const double y = end_y + 10 + 20 * static_cast<double>(s);
        svg += series.markers ? draw({{{end_x + 28, y}}}, colour_of(s))
                              : draw({{{end_x + 16, y}, {end_x + 40, y}}}, colour_of(s));
        svg += text({end_x + 48, y + 4}, "start", series.name);
    }
    return svg;
}

}  // namespace

std::string charts_svg(const std::vector<Chart>& charts) {
    double height = 0;
    std::string drawn;
    for (const Chart& chart : charts) {
        drawn += chart_svg(chart, height);
        height += chart.height;
    }
    return fmt::format(
               R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" font-family="sans-serif" font-size="13">)"
               "\n"
               R"(<rect width="{0}" height="{1}" fill="white"/>)"
               "\n",
               width, height) +
           drawn + "</svg>\n";
}

}  // namespace palpate::drawing
