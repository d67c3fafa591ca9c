// SPDX-License-Identifier: Apache-2.0
#include "runtime/openigtlink/write_message.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <igtl_header.h>
#include <igtl_point.h>
#include <igtl_sensor.h>
#include <igtl_transform.h>
#include <igtl_unit.h>
#include <igtl_util.h>

namespace palpate::openigtlink {
namespace {

constexpr std::uint16_t ascii = 3;  // MIBenum of US-ASCII, as STRING counts encodings

template <typename T>
void append_bytes(MessageBytes& out, const T* values, std::size_t count) {
    const auto* bytes = reinterpret_cast<const std::byte*>(values);
    out.insert(out.end(), bytes, bytes + count * sizeof(T));
}

template <typename Unsigned>
void append_big_endian(MessageBytes& out, Unsigned value) {
    for (std::size_t i = sizeof(Unsigned); i-- > 0;) out.push_back(static_cast<std::byte>(value >> 8 * i));
}

template <std::size_t size>
void copy_text(char (&field)[size], std::string_view text, std::size_t longest = size) {
    std::memset(field, 0, size);
    std::memcpy(field, text.data(), std::min(text.size(), longest));
}

// Appends the body by `append_body(out)`, with the head that fits it before it.
template <typename AppendBody>
void append_message(MessageBytes& out, std::string_view type, const MessageOrigin& origin,
                    const AppendBody& append_body) {
    const std::size_t start = out.size(), body = start + sizeof(igtl_header);
    out.resize(body);
    append_body();
    igtl_header head{};
    head.version = IGTL_HEADER_VERSION;
    copy_text(head.name, type);
    copy_text(head.device_name, origin.device);
    head.timestamp = origin.time;
    head.body_size = out.size() - body;
    head.crc = crc64(reinterpret_cast<unsigned char*>(out.data()) + body, head.body_size, 0);
    igtl_header_convert_byte_order(&head);
    std::memcpy(out.data() + start, &head, sizeof(head));
}

igtl_point_element point_element(const WirePoint& point) {
    igtl_point_element element{};
    copy_text(element.name, point.label, sizeof(element.name) - 1);
    copy_text(element.group_name, point.visible ? "Selected" : "Unselected");
    const std::array<igtl_uint8, 4> orange{255, 128, 0, static_cast<igtl_uint8>(point.visible ? 255 : 0)};
    std::copy(orange.begin(), orange.end(), element.rgba);
    for (Eigen::Index i = 0; i < 3; ++i)
        element.position[i] = static_cast<igtl_float32>(point.position_ras[i]);
    return element;
}

igtl_unit newton() {
    igtl_unit_data unit;
    igtl_unit_init(&unit);
    unit.unit[0] = IGTL_UNIT_SI_DERIVED_NEWTON;
    unit.exp[0] = 1;
    return igtl_unit_pack(&unit);
}

}  // namespace

std::uint64_t message_time() {
    using std::chrono::nanoseconds;
    const auto now =
        std::chrono::duration_cast<nanoseconds>(std::chrono::system_clock::now().time_since_epoch());
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(now);
    const auto rest = static_cast<std::uint64_t>((now - nanoseconds(seconds)).count());
    return static_cast<std::uint64_t>(seconds.count()) << 32 | (rest << 32) / 1'000'000'000;
}

void append_transform(MessageBytes& out, const MessageOrigin& origin, const Eigen::Matrix3d& axes_ras,
                      const Eigen::Vector3d& translation_ras) {
    Eigen::Matrix<igtl_float32, 3, 4> X;  // by columns, as the message has them
    X << axes_ras.cast<igtl_float32>(), translation_ras.cast<igtl_float32>();
    igtl_transform_convert_byte_order(X.data());
    append_message(out, "TRANSFORM", origin, [&] { append_bytes(out, X.data(), 12); });
}

void append_force_sensor(MessageBytes& out, const MessageOrigin& origin, const Eigen::Vector3d& force_ras) {
    igtl_sensor_header head{3, 0, newton()};
    std::array<igtl_float64, 3> numbers{force_ras.x(), force_ras.y(), force_ras.z()};
    igtl_sensor_convert_byte_order(&head, numbers.data());
    append_message(out, "SENSOR", origin, [&] {
        append_bytes(out, &head, 1);
        append_bytes(out, numbers.data(), numbers.size());
    });
}

void append_string(MessageBytes& out, const MessageOrigin& origin, std::string_view text) {
    append_message(out, "STRING", origin, [&] {
        append_big_endian(out, ascii);
        append_big_endian(out, static_cast<std::uint16_t>(text.size()));
        append_bytes(out, text.data(), text.size());
    });
}

void append_points(MessageBytes& out, const MessageOrigin& origin, std::span<const WirePoint> points) {
    append_message(out, "POINT", origin, [&] {
        for (const WirePoint& point : points) {
            igtl_point_element element = point_element(point);
            igtl_point_convert_byte_order(&element, 1);
            append_bytes(out, &element, 1);
        }
    });
}

void append_status(MessageBytes& out, const MessageOrigin& origin, std::uint16_t code, std::int64_t subcode,
                   std::string_view name, std::string_view text) {
    append_message(out, "STATUS", origin, [&] {
        char name_field[20];
        copy_text(name_field, name, sizeof(name_field) - 1);
        append_big_endian(out, code);
        append_big_endian(out, static_cast<std::uint64_t>(subcode));
        append_bytes(out, name_field, sizeof(name_field));
        append_bytes(out, text.data(), text.size());
        out.push_back(std::byte{0});
    });
}

}  // namespace palpate::openigtlink
