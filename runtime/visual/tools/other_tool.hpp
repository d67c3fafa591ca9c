// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

namespace palpate::visual {

/// A tool beside the one that is held: a second one, another of a recording, or the ghost of an expert's.
struct OtherTool {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< p_P, mm
    Eigen::Vector3d shaft = Eigen::Vector3d::Zero();     ///< unit, from the tip along it; zero: not known
    Eigen::Vector3d force = Eigen::Vector3d::Zero();     ///< on its device, frame P, N
    bool ghost = false;                                  ///< drawn see-through, its force fainter
    bool jaw = false;                                    ///< the held forceps' other: drawn as the held tool
};

}  // namespace palpate::visual
