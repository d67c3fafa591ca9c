// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

namespace palpate::bench {

/// One line or cloud of a chart.
struct Series {
    std::string name;
    std::vector<double> x, y;
    bool markers = false;  ///< points instead of a line
};

/// A chart of several series over one axis; what an axis shows is in its label, with the unit.
struct Chart {
    std::string title, x_label, y_label;
    std::vector<Series> series;
    bool log_x = false, log_y = false;
};

/// Draws charts one below the other as one SVG picture, 960 wide, 360 high each, on white, with a legend. Of
/// the many points of a line in one pixel column only the extremes are drawn, so peaks stay; of markers, one
/// per pixel. Values that are not finite, or not positive on a log axis, interrupt a line.
std::string charts_svg(const std::vector<Chart>& charts);

}  // namespace palpate::bench
