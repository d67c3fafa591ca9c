// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace palpate::drawing {

/// One line or cloud of a chart.
struct Series {
    std::string name;
    std::vector<double> x{}, y{};
    bool markers = false;  ///< points instead of a line
    bool right = false;    ///< y is read on the right axis
};

/// A chart of several series over one axis; what an axis shows is in its label, with the unit.
struct Chart {
    std::string title, x_label, y_label;
    std::vector<Series> series{};
    bool log_x = false, log_y = false;
    std::string right_label{};  ///< of a linear axis on the right; empty: there is none
    double height = 360;        ///< pixels
};

/// Draws charts one below the other as one SVG picture, 960 wide, on white. A legend names the series; where
/// there is a right axis, both axes have the colour of what is read on them instead. Of the many points of a
/// line in one pixel column only the extremes are drawn, so peaks stay; of markers, one per pixel. Values
/// that are not finite, or not positive on a log axis, interrupt a line.
std::string charts_svg(const std::vector<Chart>& charts);

}  // namespace palpate::drawing
