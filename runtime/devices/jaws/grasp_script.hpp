// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <string_view>

#include "formats/records/jaw_settings.hpp"
#include "runtime/devices/hand_path.hpp"

namespace palpate::devices {

inline constexpr std::string_view grasp_script = "grasp";  ///< its name

/// What a forceps does at a rim.
struct Grasp {
    Eigen::Vector3d meet;            ///< where its tips come to be, within the tissue, p_P, mm
    Eigen::Quaterniond orientation;  ///< R_PT
    double thickness = 0;            ///< of the tissue there, mm
    double depth = 0;                ///< of the tips below the rim, mm

    Eigen::Vector3d out() const { return orientation * Eigen::Vector3d::UnitZ(); }  ///< along the shaft
    Eigen::Vector3d rim() const { return meet + depth * out(); }                    ///< p_P, mm
    /// From where the tips go in, as far outside the rim as they go below it.
    Eigen::Vector3d outside() const { return rim() + depth * out(); }
};

/// How hard and how far.
struct GraspSettings {
    double pull = 5;      ///< mm, along the shaft
    double speed = 20;    ///< mm/s
    double pinch = 0.75;  ///< by how much of its thickness the tissue is pressed together
    double hold_s = 0.5;
    double seconds = 10;  ///< repeated until this time
};

/// Goes in with open jaws, closes them, holds, pulls back along the shaft, holds, goes back, opens, and
/// leaves; over and over. Throws UsageError if a number makes no sense.
HandPath grasp_path(const Grasp& grasp, const JawSettings& jaws, const GraspSettings& settings);

}  // namespace palpate::devices
