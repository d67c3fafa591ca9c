// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/live_stream.hpp"

#include <array>

#include "runtime/openigtlink/contact_point.hpp"

namespace palpate::session {

LiveStream::LiveStream(const std::string& address, const Case& patient_case, std::size_t tool_count)
    : case_(patient_case),
      stream_({.address = openigtlink::parse_stream_address(address), .tool_count = tool_count}) {}

void LiveStream::show(const TickResult& result) noexcept {
    std::array<Eigen::Vector3d, max_contacts> points;
    std::size_t count = 0;
    for (const Contact& contact : result.active_contacts()) {
        const auto body = static_cast<std::size_t>(contact.body);
        const std::size_t rigid = case_.rigid_bodies.size();
        const auto& vertices = body < rigid ? case_.rigid_bodies[body].surface.vertices
                                            : case_.deformable_bodies[body - rigid].boundary.surface.vertices;
        points[count++] = openigtlink::contact_point(contact, vertices);
    }
    stream_.publish(result, std::span(points).first(count));
}

}  // namespace palpate::session
