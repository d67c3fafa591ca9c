// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace palpate::openigtlink {

/// Whole OpenIGTLink messages of version 1, one after the other.
using MessageBytes = std::vector<std::byte>;

/// Of whom a message tells, and when.
struct MessageOrigin {
    std::string_view device;  ///< cut after 20 bytes
    std::uint64_t time = 0;   ///< s since 1970, in units of 2^-32 s
};

/// The time now, as messages carry it.
std::uint64_t message_time();

/// One point of a POINT message.
struct WirePoint {
    Eigen::Vector3d position_ras;  ///< mm
    std::string_view label;        ///< cut after 63 bytes
    bool visible = true;           ///< opaque, or of alpha 0, which 3D Slicer hides
};

/// Each appends one message. All places and directions are in RAS.
void append_transform(MessageBytes& out, const MessageOrigin& origin, const Eigen::Matrix3d& axes_ras,
                      const Eigen::Vector3d& translation_ras);
/// SENSOR: three numbers in newtons.
void append_force_sensor(MessageBytes& out, const MessageOrigin& origin, const Eigen::Vector3d& force_ras);
/// STRING, in ASCII.
void append_string(MessageBytes& out, const MessageOrigin& origin, std::string_view text);
void append_points(MessageBytes& out, const MessageOrigin& origin, std::span<const WirePoint> points);
/// STATUS: `name` is cut after 19 bytes.
void append_status(MessageBytes& out, const MessageOrigin& origin, std::uint16_t code, std::int64_t subcode,
                   std::string_view name, std::string_view text);

}  // namespace palpate::openigtlink
