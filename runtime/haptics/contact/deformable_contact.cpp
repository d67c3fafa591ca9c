// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/deformable_contact.hpp"

#include <algorithm>
#include <array>

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
    std::array<NodeForce, most_loaded> forces;
    std::size_t count = 0;
    const auto load = [&](std::int32_t vertex, const Vector3f& force) {
        const std::int32_t block = blocks_[vertex];
        if (block < 0) return;
        const auto end = forces.begin() + static_cast<std::ptrdiff_t>(count);
        const auto known = std::ranges::find(forces.begin(), end, block, &NodeForce::node);
        if (known != end)
            known->force += force;
        else if (count < forces.size())
            forces[count++] = {block, force};
    };
    const auto spread = [&](std::int32_t vertex, float weight, const Vector3f& push) {
        if (!spread_) return load(vertex, weight * push);
        for (const LoadSpread::Share& share : spread_->shares(vertex))
            load(share.vertex, weight * share.weight * push);
    };
    for (const Contact& contact : contacts) {
        if (!(contact.force > 0)) continue;
        const Vector3f push = -reaction_of(contact).cast<float>();
        if (contact.other_body == body_index_) spread(contact.other_vertex, 1, -push);
        if (contact.body != body_index_) continue;
        for (std::size_t i = 0; i < 3 && contact.vertices[i] >= 0; ++i)
            spread(contact.vertices[i], contact.weights[i], push);
    }
    std::ranges::fill(displacements, Vector3f::Zero());
    const auto contact_nodes = static_cast<std::size_t>(node_count(compliance_));
    add_displacements(compliance_, std::span(forces).first(count), displacements.first(contact_nodes));
    // Contact nodes are surface vertices in the same order, so that each goes up to its vertex in place.
    for (std::size_t v = displacements.size(); v-- > 0;)
        displacements[v] = blocks_[v] >= 0 ? displacements[blocks_[v]] : Vector3f::Zero();
}

}  // namespace palpate::haptics
