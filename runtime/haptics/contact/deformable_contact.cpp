// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/deformable_contact.hpp"

#include <algorithm>
#include <array>

#include "runtime/haptics/contact/fixed_list.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Vector3f;

constexpr std::size_t most_loaded = 2048;  // nodes of all contacts

}  // namespace

Eigen::Matrix3f DeformableContact::compliance_between(std::int32_t a, std::int32_t b) const noexcept {
    if (spread_)
        if (const auto near = spread_->near_compliance(a, b)) return *near;
    if (blocks_[a] < 0 || blocks_[b] < 0) return Eigen::Matrix3f::Zero();
    return compliance_block(compliance_, blocks_[a], blocks_[b]);
}

std::int64_t DeformableContact::memory_ticks() const noexcept {
    std::int64_t ticks = 0;
    for (const TickCreep& creep : creep_) ticks = std::max(ticks, creep.memory_ticks);
    return ticks;
}

void DeformableContact::surface_displacement(std::span<const Contact> contacts,
                                             std::span<Vector3f> displacements) const noexcept {
    FixedList<SurfaceForce, 4 * max_contacts> forces;
    append_forces(contacts, forces);
    displace({forces.data(), forces.size()}, displacements);
}

void DeformableContact::displace(std::span<const SurfaceForce> forces,
                                 std::span<Vector3f> displacements) const noexcept {
    std::array<NodeForce, most_loaded> loads;
    std::size_t count = 0;
    each_load(forces, [&](std::int32_t vertex, const Vector3f& force) {
        const std::int32_t block = blocks_[vertex];
        if (block < 0) return;
        const auto end = loads.begin() + static_cast<std::ptrdiff_t>(count);
        const auto known = std::ranges::find(loads.begin(), end, block, &NodeForce::node);
        if (known != end)
            known->force += force;
        else if (count < loads.size())
            loads[count++] = {block, force};
    });
    std::ranges::fill(displacements, Vector3f::Zero());
    const auto contact_nodes = static_cast<std::size_t>(node_count(compliance_));
    add_displacements(compliance_, std::span(loads).first(count), displacements.first(contact_nodes));
    // Contact nodes are surface vertices in the same order, so that each goes up to its vertex in place.
    for (std::size_t v = displacements.size(); v-- > 0;)
        displacements[v] = blocks_[v] >= 0 ? displacements[blocks_[v]] : Vector3f::Zero();
}

void DeformableContact::average(std::span<const Vector3f> field, std::span<Vector3f> means) const noexcept {
    if (!spread_) {
        std::ranges::copy(field, means.begin());
        return;
    }
    for (std::size_t v = 0; v < means.size(); ++v) {
        means[v].setZero();
        for (const LoadSpread::Share& share : spread_->shares(static_cast<std::int32_t>(v)))
            means[v] += share.weight * field[static_cast<std::size_t>(share.vertex)];
    }
}

}  // namespace palpate::haptics
