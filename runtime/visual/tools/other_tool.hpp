// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>

namespace palpate::visual {

/// A tool beside the one that is held.
struct OtherTool {
    enum class Kind : std::uint8_t {
        tool,   ///< a second one, or another of a recording
        ghost,  ///< an expert's: drawn see-through, its force fainter
        jaw,    ///< the held forceps' other: drawn as the held tool is
    };

    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< p_P, mm
    Eigen::Vector3d shaft = Eigen::Vector3d::Zero();     ///< unit, from the tip along it; zero: not known
    Eigen::Vector3d force = Eigen::Vector3d::Zero();     ///< on its device, frame P, N
    Kind kind = Kind::tool;
};

}  // namespace palpate::visual
