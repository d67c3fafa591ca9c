// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/force_curve.hpp"

#include <algorithm>

#include "formats/drawing/chart.hpp"

namespace palpate::session {
namespace {

void append(std::vector<CurvePoint>& points, const CurvePoint& lowest, const CurvePoint& highest) {
    if (lowest.time == highest.time) {
        points.push_back(lowest);
    } else {
        const auto [first, second] = std::minmax(
            lowest, highest, [](const CurvePoint& a, const CurvePoint& b) { return a.time < b.time; });
        points.push_back(first);
        points.push_back(second);
    }
}

bool is_lower(const CurvePoint& a, const CurvePoint& b) {
    return a.force < b.force;
}

}  // namespace

void ForceCurve::add(const CurvePoint& point) {
    lowest_ = since_ == 0 ? point : std::min(lowest_, point, is_lower);
    // Of equal ones the later, so that two stay of a rest too.
    highest_ = since_ == 0 || !is_lower(point, highest_) ? point : highest_;
    if (++since_ < span_) return;
    append(points_, lowest_, highest_);
    since_ = 0;
    if (points_.size() < most_points) return;
    std::vector<CurvePoint> fewer;
    for (auto four = points_.begin(); four != points_.end(); four += 4) {
        const auto [low, high] = std::minmax_element(four, four + 4, is_lower);
        append(fewer, *low, *high);
    }
    points_ = std::move(fewer);
    span_ *= 2;
}

std::vector<CurvePoint> ForceCurve::points() const {
    std::vector<CurvePoint> points = points_;
    if (since_ > 0) append(points, lowest_, highest_);
    return points;
}

std::string force_curve_svg(const std::vector<CurvePoint>& points, const std::string& title) {
    drawing::Series depth{.name = "depth", .right = true}, force{.name = "force"};
    for (const CurvePoint& point : points) {
        for (drawing::Series* series : {&depth, &force}) series->x.push_back(point.time);
        depth.y.push_back(point.depth);
        force.y.push_back(point.force);
    }
    return drawing::charts_svg({{.title = title,
                                 .x_label = "time (s)",
                                 .y_label = "force (N)",
                                 .series = {std::move(depth), std::move(force)},
                                 .right_label = "depth below the rest surface (mm)",
                                 .height = 420}});
}

}  // namespace palpate::session
