// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/force_curve.hpp"

#include <algorithm>

#include "formats/drawing/chart.hpp"

namespace palpate::session {
namespace {

bool is_lower(const CurvePoint& a, const CurvePoint& b) {
    return a.force < b.force;
}

}  // namespace

void ForceCurve::add(const CurvePoint& point) {
    if (since_ == 0 || is_lower(point, lowest_)) {
        lowest_ = point;
        lowest_at_ = since_;
    }
    // Of equal ones the later, so that these are two ticks.
    if (since_ == 0 || !is_lower(point, highest_)) {
        highest_ = point;
        highest_at_ = since_;
    }
    if (++since_ < span_) return;
    append_extremes(points_);
    since_ = 0;
    if (points_.size() < most_points) return;
    auto kept = points_.begin();
    for (auto four = points_.begin(); four != points_.end(); four += 4) {
        const auto [low, high] = std::minmax_element(four, four + 4, is_lower);
        const auto [first, second] = std::minmax(low, high);
        const CurvePoint one = *first, other = *second;
        *kept++ = one;
        *kept++ = other;
    }
    points_.erase(kept, points_.end());
    span_ *= 2;
}

void ForceCurve::append_extremes(std::vector<CurvePoint>& points) const {
    points.push_back(lowest_at_ < highest_at_ ? lowest_ : highest_);
    if (since_ > 1) points.push_back(lowest_at_ < highest_at_ ? highest_ : lowest_);
}

std::vector<CurvePoint> ForceCurve::points() const {
    std::vector<CurvePoint> points = points_;
    if (since_ > 0) append_extremes(points);
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
