// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "runtime/openigtlink/tool_pose.hpp"

namespace palpate::openigtlink {

/// What every OpenIGTLink message begins with.
struct MessageHead {
    static constexpr std::size_t size = 58;  ///< bytes on the wire
    int version = 1;                         ///< 2: an extended head and metadata surround the content
    std::string type;                        ///< "TRANSFORM"
    std::string device;                      ///< "Stylus"; bytes that do not print are written '?'
    std::uint64_t body_size = 0;
    std::uint64_t crc = 0;  ///< CRC-64 of the body
};

/// Reads a head; nullopt if this is none: an unknown version, a type that is no text, or a body of more than
/// 1 GiB.
std::optional<MessageHead> read_head(std::span<const std::byte, MessageHead::size> bytes);

/// Tells whether a body is the one its head was made for.
bool crc_fits(const MessageHead& head, std::span<const std::byte> body);

/// A pose, or what is wrong with it.
struct PoseReading {
    std::optional<ToolPose> pose;
    std::string problem;
};

/// Tells whether messages of this type carry a pose: TRANSFORM, POSITION and QTRANS.
bool carries_pose(const MessageHead& head);
/// Reads the pose of such a message: the tip is the translation (mm), the shaft lies along -z of the
/// rotation, the convention of Plus (user manual, "Definition of commonly used coordinate systems":
/// StylusTip's z axis points from the stylus's marker to its tip) and of SlicerIGT's pivot calibration. A
/// POSITION without a quaternion has no shaft. Refused: a number that is not finite, a place farther than
/// 100 m, axes that are no rotation within 1e-3 (a float32 matrix is one within 1e-6), a body of another
/// size.
PoseReading read_pose(const MessageHead& head, std::span<const std::byte> body);

/// Reads a STATUS message's code, 1 where all is well; nullopt if the body is too short.
std::optional<int> read_status_code(const MessageHead& head, std::span<const std::byte> body);

}  // namespace palpate::openigtlink
