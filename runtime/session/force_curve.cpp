// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/force_curve.hpp"

#include "formats/drawing/chart.hpp"

namespace palpate::session {

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
