// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace palpate::session {

/// One point of a force curve.
struct CurvePoint {
    double time = 0;   ///< s
    double force = 0;  ///< N
    double depth = 0;  ///< mm
};

/// Draws force (left axis, N) and depth (right axis, mm) over time (s) as an SVG picture of 960 x 420. Points
/// come in the order of time; columns with many are drawn by their extremes, so peaks stay.
std::string force_curve_svg(const std::vector<CurvePoint>& points, const std::string& title);

}  // namespace palpate::session
