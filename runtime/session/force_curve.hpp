// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace palpate::session {

/// One point of a force curve.
struct CurvePoint {
    double time = 0;   ///< s
    double force = 0;  ///< N
    double depth = 0;  ///< mm
};

/// A force curve of a run of any length in 3 MB: two minutes of ticks, then of every so many the one with the
/// smallest and the one with the largest force.
class ForceCurve {
  public:
    static constexpr std::size_t most_points = 131072;

    /// Takes the next tick's.
    void add(const CurvePoint& point);
    /// What is left of all, in the order of time.
    std::vector<CurvePoint> points() const;

  private:
    void append_extremes(std::vector<CurvePoint>& points) const;

    static_assert(most_points % 4 == 0);
    std::vector<CurvePoint> points_;
    std::size_t span_ = 2;  // ticks for which two points stay
    // Of the ticks since the last two: how many, and the one with the smallest and the one with the largest
    // force.
    std::size_t since_ = 0, lowest_at_ = 0, highest_at_ = 0;
    CurvePoint lowest_, highest_;
};

/// Draws force (left axis, N) and depth (right axis, mm) over time (s) as an SVG picture of 960 x 420. Points
/// come in the order of time; columns with many are drawn by their extremes, so peaks of force stay.
std::string force_curve_svg(const std::vector<CurvePoint>& points, const std::string& title);

}  // namespace palpate::session
