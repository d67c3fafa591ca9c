// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::visual {

/// From where a target is looked at first.
struct Sight {
    Eigen::Vector3d target = Eigen::Vector3d::Zero();        ///< p_P, mm
    Eigen::Vector3d focus = Eigen::Vector3d::Zero();         ///< the middle of the picture, p_P, mm
    Eigen::Vector3d toward_eye = -Eigen::Vector3d::UnitY();  ///< unit
    double field = 100;                                      ///< mm, height of what is seen at the target
    double view_angle_deg = 30;                              ///< of the picture's height
    bool blocked = false;                                    ///< a body stands between target and eye
    bool inside = false;  ///< the eye is in a passage, not outside the patient
    /// What is looked at closely: along a line of one point or more, p_P, mm, and so far around it, mm.
    std::vector<Eigen::Vector3d> close_up{};
    double close_up_radius = 50;

    Eigen::Vector3d eye() const;  ///< p_P, mm
    /// The picture's right, its up and the way to the eye: columns, unit, frame P. The patient's head is up,
    /// or the front where the eye looks along the body.
    Eigen::Matrix3d axes() const;
};

/// Chooses a sight of a place on a surface: down its normal, tilted towards the patient's head (or front, for
/// a normal along the body's axis) so that the tool does not hide what it touches; wide enough for the first
/// deformable body, at most 260 mm. Linear in all triangles.
Sight choose_sight(const Case& patient_case, const Eigen::Vector3d& point, const Eigen::Vector3d& normal);

}  // namespace palpate::visual
