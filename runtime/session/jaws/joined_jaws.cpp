// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/jaws/joined_jaws.hpp"

#include "formats/model/arrays.hpp"

namespace palpate::session {
namespace {

using Vector = std::array<double, 3>;

// Where tips would meet that are at `a` and `b`, of jaws that go this way to their hinge.
Vector meeting(const Vector& a, const Vector& b, const Eigen::Vector3d& shafts, double jaw_length) {
    const Eigen::Vector3d hinge = (vector_of(a) + vector_of(b) + jaw_length * shafts) / 2;
    return array_of(Eigen::Vector3d(hinge - jaw_length * shafts.normalized()));
}

}  // namespace

TickResult joined_jaws(const TickResult& first, const TickResult& second, double jaw_length) {
    TickResult joined;
    copy_active(first, joined);
    const Eigen::Vector3d shafts = vector_of(first.shaft) + vector_of(second.shaft);
    joined.device_position = meeting(first.device_position, second.device_position, shafts, jaw_length);
    joined.tool_position = meeting(first.tool_position, second.tool_position, shafts, jaw_length);
    joined.shaft = array_of(Eigen::Vector3d(shafts.normalized()));
    joined.buttons = 0;
    joined.force = array_of(Eigen::Vector3d(vector_of(first.force) + vector_of(second.force)));
    if (second.depth > first.depth) {
        joined.depth = second.depth;
        joined.body = second.body;
    }
    joined.status |= second.status;
    joined.faults |= second.faults;
    for (const Contact& contact : second.active_contacts())
        if (const auto used = static_cast<std::size_t>(joined.contact_count); used < max_contacts) {
            joined.contacts[used] = contact;
            ++joined.contact_count;
        }
    return joined;
}

}  // namespace palpate::session
