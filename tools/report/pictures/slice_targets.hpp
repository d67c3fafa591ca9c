// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "formats/model/label_map.hpp"
#include "tools/report/pictures/slices.hpp"

namespace palpate::report {

/// What three slices are to show.
struct SliceTarget {
    Eigen::Vector3d planes = Eigen::Vector3d::Zero();  ///< p_P where the three planes cross, mm
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< p_P of the windows' middle, mm
    double side = 100;  ///< mm, of a window that shows it and what is around it
    std::string name;
};

/// One target for each label of the map that occurs, around it, with the planes through that voxel of it
/// which is nearest to its centroid: the centroid of a bent structure may lie outside it. Cost: linear.
std::vector<SliceTarget> label_targets(const LabelMap& map);

/// The same for all labels taken together. Precondition: one occurs (asserted).
SliceTarget whole_target(const LabelMap& map);

/// A plane in words: its title, what lies at its four edges, and which LPS axis it crosses.
struct PlaneText {
    std::string title, left, right, top, bottom;
    int axis;            ///< of the plane's normal in LPS
    std::string higher;  ///< where that axis points
};
PlaneText plane_text(Plane plane);

/// A round length of about a quarter of `side`, mm.
double scale_bar_length(double side);

}  // namespace palpate::report
