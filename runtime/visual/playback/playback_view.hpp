// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

namespace palpate::visual {

/// A tool beside the one that is held: another of a recording, or the ghost of an expert's.
struct OtherTool {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< p_P, mm
    Eigen::Vector3d shaft = Eigen::Vector3d::Zero();     ///< unit, from the tip along it; zero: not known
    Eigen::Vector3d force = Eigen::Vector3d::Zero();     ///< on its device, frame P, N
    bool ghost = false;                                  ///< drawn see-through, its force fainter
};

/// What the timeline shows of a recording.
struct TimelineView {
    std::vector<Eigen::Vector2d> forces;  ///< least and largest of each of its columns, N
    double share = 0;                     ///< where the head is, 0 ... 1
    std::string text{};                   ///< time and speed
};

}  // namespace palpate::visual
