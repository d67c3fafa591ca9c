// SPDX-License-Identifier: Apache-2.0
// What tissue that creeps keeps of the forces of earlier ticks; part of the tick.
//
// Between vertices that creep alike, u = C (f + sum c_k q_k), q_k what is left of f (creep.hpp). In a tick,
// the blocks are now C, and the rest displaces as if it were held. Between vertices that creep otherwise, or
// one of which does not creep, u = C f: so each term's compliance is a principal part of C and positive
// semidefinite, and a closed way loses energy and never gives any. What is left of the displacements C f is
// kept beside what is left of f: it needs no products with C, but where a vertex comes in, and goes on where
// the vertex that was pressed had to go.
#include "runtime/haptics/contact/equilibrium/deformed_patch.hpp"

namespace palpate::haptics {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector4f;

// Takes in the forces of the tick before.
void DeformedPatch::creep() noexcept {
    if (bears_force() || !held_.loaded.empty()) {
        remembers_ = true;
        last_loaded_ = tick_;
    }
    if (!remembers_) return;
    if (tick_ - last_loaded_ > body_->memory_ticks()) return reset();
    std::fill_n(sum_.begin(), size_, Vector4f::Zero());
    for (const Forces* forces : {&forces_, &held_})
        for (const std::int32_t loaded : forces->loaded) {
            const Vector3f force = forces->at[loaded].cast<float>();
            const Block* const row = blocks_of(loaded);
            for (std::int32_t slot = 0; slot < size_; ++slot)
                if (creeps_as_[slot] == creeps_as_[loaded]) sum_[slot] += row[slot] * force;
        }
    for (std::int32_t slot = 0; slot < size_; ++slot) {
        const TickCreep* const creep = creeps_as_[slot];
        if (creep == nullptr) continue;
        left_forces_[slot].take(*creep, forces_.at[slot] + held_.at[slot]);
        left_moves_[slot].take(*creep, sum_[slot].head<3>().cast<double>() / creep->now);
        const Vector3d lasting = left_moves_[slot].lasting(*creep) + leans_[slot];
        add_lasting(slot, lasting - lasting_[slot]);
    }
}

// Lets what displaces a vertex whatever presses in this tick do so by so much more, in all states alike.
void DeformedPatch::add_lasting(std::int32_t slot, const Vector3d& more) noexcept {
    lasting_[slot] += more;
    held_moved_[slot] += more;
    moved_[slot] += more;
    for (Answer& answer : answers_) {
        answer.held_moved[slot] += more;
        answer.moved[slot] += more;
    }
}

void DeformedPatch::enter_creep(std::int32_t slot) noexcept {
    const TickCreep* const creep = creeps_as_[slot];
    left_forces_[slot] = left_moves_[slot] = {};
    if (creep == nullptr) return;
    for (std::int32_t other = 0; other < size_; ++other) {
        if (creeps_as_[other] != creep || other == slot) continue;
        for (std::size_t k = 0; k < creep->terms.size(); ++k)
            if (const Vector3d& left = left_forces_[other].left[k]; left != Vector3d::Zero())
                left_moves_[slot].left[k] += response(slot, other, left) / creep->now;
    }
    lasting_[slot] += left_moves_[slot].lasting(*creep);
}

// How far what is left of the forces on a vertex displaces it, mm.
double DeformedPatch::dent_at(std::int32_t slot) const noexcept {
    const TickCreep* const creep = creeps_as_[slot];
    if (creep == nullptr) return 0;
    const Vector3d left = left_forces_[slot].lasting(*creep);
    return left.isZero(0) ? 0 : response(slot, slot, left).norm();
}

void DeformedPatch::release() noexcept {
    if (!remembers_) return reset();
    for (Forces* forces : {&forces_, &held_}) forces->clear();
    for (Answer& answer : answers_) answer.clear();
    load_ = part_ = 0;
    for (std::int32_t slot = 0; slot < size_; ++slot) {
        lasting_[slot] -= leans_[slot];
        leans_[slot] = leant_[slot] = Vector3d::Zero();
        moved_[slot] = held_moved_[slot] = lasting_[slot];
    }
}

}  // namespace palpate::haptics
