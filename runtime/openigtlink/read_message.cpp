// SPDX-License-Identifier: Apache-2.0
#include "runtime/openigtlink/read_message.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <igtl_header.h>
#include <igtl_transform.h>
#include <igtl_util.h>

namespace palpate::openigtlink {
namespace {

constexpr std::uint64_t largest_body = std::uint64_t{1} << 30;
constexpr double farthest_mm = 1e5;
constexpr double rotation_tolerance = 1e-3;
static_assert(MessageHead::size == IGTL_HEADER_SIZE && MessageHead::size == sizeof(igtl_header));

template <typename Unsigned>
Unsigned big_endian(std::span<const std::byte> bytes) {
    Unsigned value = 0;
    for (std::size_t i = 0; i < sizeof(Unsigned); ++i)
        value = static_cast<Unsigned>(value << 8 | std::to_integer<Unsigned>(bytes[i]));
    return value;
}

double big_endian_float(std::span<const std::byte> bytes) {
    return static_cast<double>(std::bit_cast<float>(big_endian<std::uint32_t>(bytes)));
}

bool prints(char c) {
    return c >= ' ' && c <= '~';
}

template <std::size_t size>
std::string text_until_zero(const char (&field)[size]) {
    return {field, std::find(field, field + size, '\0')};
}

// What is between the extended head and the metadata of a message of version 2; nullopt if their sizes
// contradict the body's.
std::optional<std::span<const std::byte>> content_of(const MessageHead& head,
                                                     std::span<const std::byte> body) {
    if (head.version < 2) return body;
    if (body.size() < 12) return std::nullopt;
    const std::size_t before = big_endian<std::uint16_t>(body);
    const std::size_t after =
        std::size_t{big_endian<std::uint16_t>(body.subspan(2))} + big_endian<std::uint32_t>(body.subspan(4));
    if (before < 12 || before + after > body.size()) return std::nullopt;
    return body.subspan(before, body.size() - before - after);
}

// `axes_ras`: a rotation; zero where the message has none.
PoseReading checked(const Eigen::Vector3d& tip_ras, const Eigen::Matrix3d& axes_ras) {
    if (!tip_ras.allFinite()) return {{}, "its position is not a finite number"};
    if (tip_ras.cwiseAbs().maxCoeff() > farthest_mm) return {{}, "its position is farther than 100 m"};
    ToolPose pose{flip_lps_ras(tip_ras), flip_lps_ras(-axes_ras.col(2))};
    if (!axes_ras.isZero(0)) pose.orientation = Eigen::Quaterniond(flip_axes(axes_ras)).normalized();
    return {pose, {}};
}

PoseReading read_transform(std::span<const std::byte> content) {
    if (content.size() != IGTL_TRANSFORM_SIZE)
        return {{}, "a TRANSFORM of " + std::to_string(content.size()) + " bytes instead of 48"};
    Eigen::Matrix<double, 3, 4> X;  // columns as they come: three axes, then the translation
    for (Eigen::Index i = 0; i < 12; ++i)
        X(i % 3, i / 3) = big_endian_float(content.subspan(4 * static_cast<std::size_t>(i)));
    if (!X.allFinite()) return {{}, "its matrix has a number that is not finite"};
    const Eigen::Matrix3d R = X.leftCols<3>();
    const double error = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (error > rotation_tolerance || R.determinant() < 0)
        return {{}, "the axes of its matrix are no rotation, as a mirror or a scale is none"};
    return checked(X.col(3), Eigen::Quaterniond(R).normalized().toRotationMatrix());
}

// Three numbers of position, then none, three or four of a quaternion (x, y, z, w).
PoseReading read_position(std::span<const std::byte> content) {
    if (content.size() != 12 && content.size() != 24 && content.size() != 28)
        return {{}, "a POSITION of " + std::to_string(content.size()) + " bytes instead of 12, 24 or 28"};
    std::array<double, 7> number{};
    for (std::size_t i = 0; i < content.size() / 4; ++i) number[i] = big_endian_float(content.subspan(4 * i));
    const Eigen::Vector3d tip(number[0], number[1], number[2]);
    if (content.size() == 12) return checked(tip, Eigen::Matrix3d::Zero());
    const Eigen::Vector3d xyz(number[3], number[4], number[5]);
    const double w = content.size() == 28 ? number[6] : std::sqrt(std::max(0.0, 1 - xyz.squaredNorm()));
    const Eigen::Quaterniond q(w, xyz.x(), xyz.y(), xyz.z());
    if (!(std::abs(q.norm() - 1) <= rotation_tolerance)) return {{}, "its quaternion is no rotation"};
    return checked(tip, q.normalized().toRotationMatrix());
}

}  // namespace

Eigen::Matrix3d rotation_with_z(const Eigen::Vector3d& axis) {
    if (axis.isZero(0)) return Eigen::Matrix3d::Identity();
    return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis).toRotationMatrix();
}

std::optional<MessageHead> read_head(std::span<const std::byte, MessageHead::size> bytes) {
    igtl_header wire;
    std::memcpy(&wire, bytes.data(), sizeof(wire));
    igtl_header_convert_byte_order(&wire);
    MessageHead head{wire.version, text_until_zero(wire.name), text_until_zero(wire.device_name),
                     wire.body_size, wire.crc};
    if (head.version < 1 || head.version > 3 || head.type.empty() || head.body_size > largest_body ||
        !std::all_of(head.type.begin(), head.type.end(), prints))
        return std::nullopt;
    std::replace_if(
        head.device.begin(), head.device.end(), [](char c) { return !prints(c); }, '?');
    return head;
}

bool crc_fits(const MessageHead& head, std::span<const std::byte> body) {
    // The library only reads, though it asks for a pointer to what may be written.
    auto* bytes = const_cast<unsigned char*>(reinterpret_cast<const unsigned char*>(body.data()));
    return crc64(bytes, body.size(), 0) == head.crc;
}

bool carries_pose(const MessageHead& head) {
    return head.type == "TRANSFORM" || head.type == "POSITION" || head.type == "QTRANS";
}

PoseReading read_pose(const MessageHead& head, std::span<const std::byte> body) {
    const auto content = content_of(head, body);
    if (!content) return {{}, "its extended head contradicts its size"};
    return head.type == "TRANSFORM" ? read_transform(*content) : read_position(*content);
}

std::optional<int> read_status_code(const MessageHead& head, std::span<const std::byte> body) {
    const auto content = content_of(head, body);
    if (!content || content->size() < 2) return std::nullopt;
    return big_endian<std::uint16_t>(*content);
}

}  // namespace palpate::openigtlink
