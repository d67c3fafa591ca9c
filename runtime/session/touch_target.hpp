// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/devices/hand_path.hpp"
#include "runtime/haptics/haptic_model.hpp"

namespace palpate::session {

/// A place on a body that the tool can reach.
struct TouchTarget {
    std::size_t body = 0;       ///< as in HapticModel
    std::int32_t triangle = 0;  ///< of its surface
    devices::TouchPoint place;
};

/// The point of a body's surface (`body` as in HapticModel) that is nearest to `place` (p_P, mm), with how
/// far the tool can back out of it; nothing if the tool does not fit there.
std::optional<TouchTarget> touch_target_near(const Case& patient_case, const haptics::HapticModel& model,
                                             std::size_t body, const Eigen::Vector3d& place);

/// Which body `name` is, as in HapticModel; empty: the first deformable one, else the first rigid one. Throws
/// UsageError for an unknown name, or one that the model's method does not feel.
std::size_t find_body(const haptics::HapticModel& model, const std::string& name);

/// The surface of a body, as in HapticModel.
const TriangleMesh& surface_of(const Case& patient_case, std::size_t body);

/// The triangles of a body's surface none of whose vertices is fixed; all of a rigid body.
std::vector<std::int32_t> free_triangles(const Case& patient_case, std::size_t body);

/// Chooses where a script touches. `body_name` empty: the first deformable body, else the first rigid one.
/// Without `near`: among the body's free triangles from which the tool can back out 5 mm (or, in a narrow
/// cavity, as far as any allows), the one farthest from the fixed nodes, where the body gives way most; on a
/// rigid body, the one farthest from the surface's centroid. With `near` (p_P, mm): the surface point nearest
/// to it. Throws UsageError for an unknown name, InvalidInput if the tool reaches no triangle.
TouchTarget choose_touch_target(const Case& patient_case, const haptics::HapticModel& model,
                                const std::string& body_name, const std::optional<Eigen::Vector3d>& near);

/// Where the centre of a tool of that radius (mm) starts: 5 mm clear of the place, or as far as it is free.
inline Eigen::Vector3d start_outside(const devices::TouchPoint& place, double tool_radius) {
    return place.point + place.normal * (tool_radius + std::min(5.0, place.clearance));
}

}  // namespace palpate::session
