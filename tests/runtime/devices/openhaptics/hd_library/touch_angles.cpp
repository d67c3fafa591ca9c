// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/devices/openhaptics/hd_library/touch_angles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::hd {
namespace {

constexpr double link = 133.35;                    // mm, both
constexpr double offset_y = -110, offset_z = -35;  // mm, of the tip where all angles are zero

}  // namespace

std::array<double, 3> touch_angles(const std::array<double, 3>& position) noexcept {
    const double forward = position[2] - offset_z + link;
    const double out = std::hypot(position[0], forward), up = position[1] - offset_y - link;
    // Links of one length make an isosceles triangle: each is half its apex away from the line to the tip.
    const double middle = std::atan2(up, out);
    const double half = std::acos(std::min(1.0, std::hypot(out, up) / (2 * link)));
    return {std::atan2(-position[0], forward), middle + half, middle - half + std::numbers::pi / 2};
}

std::array<double, 3> touch_position(const std::array<double, 3>& angles) noexcept {
    const double out = link * (std::cos(angles[1]) + std::sin(angles[2]));
    return {-std::sin(angles[0]) * out, link * (std::sin(angles[1]) - std::cos(angles[2])) + link + offset_y,
            std::cos(angles[0]) * out - link + offset_z};
}

}  // namespace palpate::hd
