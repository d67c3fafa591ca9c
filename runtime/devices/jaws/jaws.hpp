// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <atomic>
#include <memory>
#include <numbers>

#include "formats/records/jaw_settings.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate::devices {

/// How a forceps is turned and opened where its device does not say.
struct JawHold {
    Eigen::Quaterniond orientation{1, 0, 0, 0};  ///< R_PT: its shaft is along z, its jaws open along x
    /// Set from another thread where keys close the jaws.
    std::shared_ptr<const std::atomic<bool>> closed;
};

/// A jaw's tip (p_P, mm) and the unit vector from there to the hinge.
struct JawPlace {
    Eigen::Vector3d tip = Eigen::Vector3d::Zero(), shaft = Eigen::Vector3d::Zero();
};

/// Where a forceps' two jaws are whose tips meet at `meet` (p_P, mm) when they are closed; then their
/// surfaces touch each other. `angle`: between them, rad. Realtime-safe.
std::array<JawPlace, 2> jaw_places(const Eigen::Vector3d& meet, const Eigen::Quaterniond& orientation,
                                   const JawSettings& jaws, double angle) noexcept;

/// The two jaws of a forceps that one device holds, as a device each: its position is where closed tips meet.
/// The device feels the sum of what both feel, and each jaw may have half of what it bears. The angle is the
/// device's own, DeviceState::jaw_angle; else the jaws close at closing_speed while its first button is down
/// or `hold.closed` is true, and open again after. The two are read and written in turn by one thread.
std::array<std::shared_ptr<realtime::Device>, 2> jaws_of(std::shared_ptr<realtime::Device> device,
                                                         const JawSettings& jaws, JawHold hold);

inline constexpr double closing_speed = 1;  ///< rad/s

/// The angle between open jaws, rad.
inline double open_angle(const JawSettings& jaws) {
    return jaws.jaw_opening * std::numbers::pi / 180;
}

/// What a hand may get of whose jaws each may give it so much.
inline DeviceLimits limits_of_both(DeviceLimits of_one) {
    of_one.max_force *= 2;
    of_one.max_stiffness *= 2;
    return of_one;
}

}  // namespace palpate::devices
