// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>

#include "formats/model/body.hpp"
#include "formats/records/jaw_settings.hpp"
#include "runtime/devices/jaws/grasp_script.hpp"
#include "runtime/haptics/haptic_model.hpp"

namespace palpate::session {

/// Where a forceps takes hold of an organ's rim: its open jaws go in on either side.
struct GraspPlace {
    std::size_t body = 0;  ///< as in HapticModel
    devices::Grasp grasp;
};

/// How far below a rim the tips of jaws of that length go, mm.
inline double grasp_depth(double jaw_length) {
    return 0.5 * jaw_length;
}

/// Finds the thinnest rim of a deformable body that the open jaws reach from outside, clear of all bodies and
/// with the tips no nearer to what is held than to the rim; with `near` (p_P, mm) the rim nearest to it.
/// `body_name` empty: the first deformable body. Throws UsageError for an unknown name or a rigid body,
/// InvalidInput if no rim fits between the jaws.
GraspPlace choose_grasp_place(const Case& patient_case, const haptics::HapticModel& model,
                              const JawSettings& jaws, const std::string& body_name,
                              const std::optional<Eigen::Vector3d>& near);

}  // namespace palpate::session
