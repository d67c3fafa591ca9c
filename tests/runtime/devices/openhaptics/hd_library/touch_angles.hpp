// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

namespace palpate::hd {

/// Computes the joint angles (rad) of a Touch whose tip is at `position` (frame D, mm): two links of
/// 133.35 mm, the arm's elbow up. A tip out of reach gives the angles of the straight arm towards it.
/// Source: the device's published configuration, links and WorkspaceOffset (0, -110, -35).
std::array<double, 3> touch_angles(const std::array<double, 3>& position) noexcept;

/// The inverse: where the tip is (frame D, mm).
std::array<double, 3> touch_position(const std::array<double, 3>& angles) noexcept;

}  // namespace palpate::hd
