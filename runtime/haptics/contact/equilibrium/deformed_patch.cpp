// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/equilibrium/deformed_patch.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::haptics {

using namespace collision;
using Eigen::Vector3d;

void DeformedPatch::Forces::clear() noexcept {
    for (const std::int32_t slot : loaded) at[slot].setZero();
    loaded.clear();
}

void DeformedPatch::Forces::add(std::int32_t slot, const Vector3d& force) noexcept {
    if (std::find(loaded.begin(), loaded.end(), slot) == loaded.end()) loaded.push_back(slot);
    at[slot] += force;
}

void DeformedPatch::Forces::drop(std::int32_t slot) noexcept {
    loaded.erase_if([&](std::int32_t other) { return other == slot; });
    at[slot].setZero();
}

void DeformedPatch::reset() noexcept {
    forces_.clear();
    held_.clear();
    combined_.clear();
    for (Answer& answer : answers_) answer.forces.clear();
    for (std::int32_t slot = 0; slot < size_; ++slot) slots_[vertices_[slot]] = no_slot;
    size_ = 0;
    tick_ = 0;
}

void DeformedPatch::begin_tick() noexcept {
    ++tick_;
    std::copy_n(moved_.begin(), size_, before_.begin());
}

// Room is made by vertices that nobody looks at and nothing presses.
std::int32_t DeformedPatch::free_slot() noexcept {
    if (size_ < most_vertices) return size_++;
    for (std::int32_t slot = 0; slot < size_; ++slot) {
        const bool loaded = forces_.at[slot] != Vector3d::Zero() || held_.at[slot] != Vector3d::Zero();
        if (loaded || seen_[slot] >= tick_) continue;
        slots_[vertices_[slot]] = no_slot;
        for (Answer& answer : answers_) answer.forces.drop(slot);
        return slot;
    }
    return no_slot;
}

// no_slot where there is no room left.
std::int32_t DeformedPatch::slot_of(std::int32_t vertex) noexcept {
    std::int32_t slot = slots_[vertex];
    const bool slot_is_new = slot == no_slot;
    if (slot_is_new) {
        slot = free_slot();
        if (slot == no_slot) return no_slot;
        slots_[vertex] = slot;
        vertices_[slot] = vertex;
        rest_[slot] = body_->rest_position(vertex);
        for (std::int32_t other = 0; other < size_; ++other) {
            const Eigen::Matrix3f between = body_->compliance_between(vertex, vertices_[other]);
            blocks_[static_cast<std::size_t>(slot * most_vertices + other)] = between;
            blocks_[static_cast<std::size_t>(other * most_vertices + slot)] = between.transpose();
        }
    }
    if (slot_is_new || seen_[slot] != tick_) {  // where nobody looked, nothing was kept up to date
        before_[slot] = moved_[slot] = displacement_under(forces_, slot) + displacement_under(held_, slot);
        for (Answer& answer : answers_) {
            answer.moved[slot] = moved_[slot];
            answer.difference[slot].setZero();
        }
        seen_[slot] = tick_;
    }
    return slot;
}

bool DeformedPatch::slots_of(std::int32_t triangle, std::array<std::int32_t, 3>& slots) noexcept {
    for (std::size_t corner = 0; corner < 3; ++corner) {
        slots[corner] = slot_of(body_->triangle(triangle)[corner]);
        if (slots[corner] == no_slot) return false;
    }
    return true;
}

TriangleCorners DeformedPatch::look_at(std::int32_t triangle) const noexcept {
    TriangleCorners corners;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::int32_t vertex = body_->triangle(triangle)[corner], slot = slots_[vertex];
        if (slot != no_slot && seen_[slot] == tick_) {
            corners[corner] = position(slot);
            continue;
        }
        corners[corner] = body_->rest_position(vertex);
        for (const Forces* forces : {&forces_, &held_})
            for (const std::int32_t loaded : forces->loaded)
                corners[corner] +=
                    (body_->compliance_between(vertex, vertices_[loaded]) * forces->at[loaded].cast<float>())
                        .cast<double>();
    }
    return corners;
}

double DeformedPatch::motion() const noexcept {
    double most = 0;
    for (std::int32_t slot = 0; slot < size_; ++slot)
        if (seen_[slot] == tick_) most = std::max(most, (moved_[slot] - before_[slot]).squaredNorm());
    return std::sqrt(most);
}

Vector3d DeformedPatch::displacement_under(const Forces& forces, std::int32_t slot) const noexcept {
    Vector3d sum = Vector3d::Zero();
    for (const std::int32_t loaded : forces.loaded) sum += response(slot, loaded, forces.at[loaded]);
    return sum;
}

void DeformedPatch::begin_answer(std::size_t iterate) noexcept {
    answers_[iterate].forces.clear();
}

void DeformedPatch::load_answer(std::size_t iterate, std::int32_t slot, const Vector3d& force) noexcept {
    answers_[iterate].forces.add(slot, force);
}

double DeformedPatch::end_answer(std::size_t iterate) noexcept {
    Answer& answer = answers_[iterate];
    double most = 0;
    for (std::int32_t slot = 0; slot < size_; ++slot) {
        if (seen_[slot] != tick_) continue;
        answer.moved[slot] = displacement_under(answer.forces, slot) + displacement_under(held_, slot);
        answer.difference[slot] = answer.moved[slot] - moved_[slot];
        most = std::max(most, answer.difference[slot].lpNorm<Eigen::Infinity>());
    }
    return most;
}

double DeformedPatch::product_of_differences(std::size_t a, std::size_t b) const noexcept {
    double sum = 0;
    for (std::int32_t slot = 0; slot < size_; ++slot)
        if (seen_[slot] == tick_) sum += answers_[a].difference[slot].dot(answers_[b].difference[slot]);
    return sum;
}

void DeformedPatch::relax_to(const std::array<double, iterates>& weights, double step) noexcept {
    combined_.clear();
    for (const std::int32_t slot : forces_.loaded) combined_.add(slot, (1 - step) * forces_.at[slot]);
    for (std::size_t k = 0; k < iterates; ++k) {
        if (weights[k] == 0) continue;
        for (const std::int32_t slot : answers_[k].forces.loaded)
            combined_.add(slot, step * weights[k] * answers_[k].forces.at[slot]);
    }
    std::swap(forces_, combined_);
    forces_.loaded.erase_if([&](std::int32_t slot) { return forces_.at[slot] == Vector3d::Zero(); });
    for (std::int32_t slot = 0; slot < size_; ++slot) {
        if (seen_[slot] != tick_) continue;
        Vector3d to = Vector3d::Zero();
        for (std::size_t k = 0; k < iterates; ++k)
            if (weights[k] != 0) to += weights[k] * answers_[k].moved[slot];
        moved_[slot] += step * (to - moved_[slot]);
    }
}

void DeformedPatch::clear_held() noexcept {
    held_.clear();
}

void DeformedPatch::hold(std::int32_t slot, const Vector3d& force) noexcept {
    held_.add(slot, force);
}

Vector3d DeformedPatch::held_displacement(std::int32_t slot) const noexcept {
    return displacement_under(held_, slot);
}

}  // namespace palpate::haptics
