// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/model/arrays.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate::devices {

/// Whether a tool's orientation is known; it is zero where it is not. Realtime-safe.
inline bool is_known(const Eigen::Quaterniond& orientation) noexcept {
    return !orientation.coeffs().isZero(0);
}

/// Writes a tool's orientation to a state, and with it where its shaft goes; nothing where the orientation is
/// not known. Realtime-safe.
inline void set_orientation(realtime::DeviceState& state, const Eigen::Quaterniond& orientation) noexcept {
    if (!is_known(orientation)) return;
    state.orientation = array_of(orientation);
    state.shaft = array_of(Eigen::Vector3d(orientation * Eigen::Vector3d::UnitZ()));
}

}  // namespace palpate::devices
