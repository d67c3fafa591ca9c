// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/equilibrium/deformed_patch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector4f;

constexpr std::int64_t kept = 32;  // ticks for which a vertex stays that nobody looks at
constexpr double faded = 1e-4;     // mm: a dent smaller than this keeps no vertex
// Vertices beyond which dents give way to what is near a tool now.
constexpr std::int32_t crowded = DeformedPatch::most_vertices / 2;

}  // namespace

void DeformedPatch::Forces::clear() noexcept {
    for (const std::int32_t slot : loaded) at[slot].setZero();
    loaded.clear();
    is_loaded.reset();
}

void DeformedPatch::Forces::add(std::int32_t slot, const Vector3d& force) noexcept {
    if (!is_loaded[static_cast<std::size_t>(slot)]) loaded.push_back(slot);
    is_loaded[static_cast<std::size_t>(slot)] = true;
    at[slot] += force;
}

void DeformedPatch::Forces::take(const Forces& other) noexcept {
    clear();
    for (const std::int32_t slot : other.loaded) add(slot, other.at[slot]);
}

void DeformedPatch::Forces::drop(std::int32_t slot) noexcept {
    if (!is_loaded[static_cast<std::size_t>(slot)]) return;
    loaded.erase_if([&](std::int32_t other) { return other == slot; });
    is_loaded[static_cast<std::size_t>(slot)] = false;
    at[slot].setZero();
}

void DeformedPatch::Forces::move(std::int32_t from, std::int32_t to) noexcept {
    const auto listed = std::find(loaded.begin(), loaded.end(), from);
    if (listed == loaded.end()) return;
    *listed = to;
    is_loaded[static_cast<std::size_t>(from)] = false;
    is_loaded[static_cast<std::size_t>(to)] = true;
    std::swap(at[from], at[to]);
}

void DeformedPatch::reset() noexcept {
    for (Forces* forces : {&forces_, &held_}) forces->clear();
    for (Answer& answer : answers_) answer.clear();
    for (std::int32_t slot = 0; slot < size_; ++slot) slots_[vertices_[slot]] = no_slot;
    size_ = 0;
    tick_ = 0;
    kept_in_ = not_kept;
    remembers_ = false;
    load_ = part_ = 0;
}

void DeformedPatch::begin_tick() noexcept {
    ++tick_;
    kept_in_ = not_kept;
    std::copy_n(moved_.begin(), size_, before_.begin());
    if (shape_ != nullptr) lean();
    if (body_->creeps()) creep();
    drop_one();  // in a tick is enough
}

// The vertex that bears least of a dent, if it bears nothing else.
void DeformedPatch::drop_one() noexcept {
    std::int32_t weakest = no_slot;
    double least = size_ > crowded ? std::numeric_limits<double>::infinity() : faded;
    for (std::int32_t slot = size_; slot-- > 0;) {
        const bool loaded = forces_.at[slot] != Vector3d::Zero() || held_.at[slot] != Vector3d::Zero();
        if (loaded || seen_[slot] + kept >= tick_) continue;
        const double dent = dent_at(slot);
        if (dent >= least) continue;
        weakest = slot;
        least = dent;
        if (dent == 0) break;
    }
    if (weakest != no_slot) drop(weakest);
}

// The last slot takes the place of this one, which bears nothing; an answer of some ticks before may have
// loaded it.
void DeformedPatch::drop(std::int32_t slot) noexcept {
    slots_[vertices_[slot]] = no_slot;
    for (Answer& answer : answers_) {
        answer.forces.drop(slot);
        answer.held.drop(slot);
    }
    const std::int32_t last = --size_;
    if (slot == last) return;
    vertices_[slot] = vertices_[last];
    slots_[vertices_[slot]] = slot;
    rest_[slot] = rest_[last];
    gives_way_[static_cast<std::size_t>(slot)] = gives_way_[static_cast<std::size_t>(last)];
    moved_[slot] = moved_[last];
    before_[slot] = before_[last];
    measured_[slot] = measured_[last];
    held_moved_[slot] = held_moved_[last];
    seen_[slot] = seen_[last];
    creeps_as_[slot] = creeps_as_[last];
    left_forces_[slot] = left_forces_[last];
    left_moves_[slot] = left_moves_[last];
    lasting_[slot] = lasting_[last];
    leans_[slot] = leans_[last];
    leant_[slot] = leant_[last];
    forces_.move(last, slot);
    held_.move(last, slot);
    for (Answer& answer : answers_) {
        answer.forces.move(last, slot);
        answer.held.move(last, slot);
        answer.moved[slot] = answer.moved[last];
        answer.held_moved[slot] = answer.held_moved[last];
        answer.difference[slot] = answer.difference[last];
    }
    const auto at = [&](std::int32_t to, std::int32_t loaded) -> Block& {
        return blocks_[static_cast<std::size_t>(loaded * most_vertices + to)];
    };
    for (std::int32_t other = 0; other < size_; ++other) {
        const std::int32_t from = other == slot ? last : other;
        at(other, slot) = at(from, last);
        at(slot, other) = at(last, from);
    }
    known_[static_cast<std::size_t>(slot)] = known_[static_cast<std::size_t>(last)];
}

void DeformedPatch::know(std::int32_t loaded) const noexcept {
    known_[static_cast<std::size_t>(loaded)] = true;
    const std::int32_t vertex = vertices_[loaded];
    for (std::int32_t slot = 0; slot < size_; ++slot)
        set_block(slot, loaded,
                  growth(creeps_as_[loaded], creeps_as_[slot]) *
                      body_->compliance_between(vertex, vertices_[slot]).transpose());
}

void DeformedPatch::set_block(std::int32_t slot, std::int32_t loaded,
                              const Eigen::Matrix3f& compliance) const noexcept {
    Block& to = blocks_[static_cast<std::size_t>(loaded * most_vertices + slot)];
    to.topRows<3>() = compliance;
    to.row(3).setZero();
}

// no_slot where there is no room left.
std::int32_t DeformedPatch::slot_of(std::int32_t vertex) noexcept {
    std::int32_t slot = slots_[vertex];
    if (slot == no_slot) {
        if (size_ == most_vertices) return no_slot;
        slot = slots_[vertex] = size_++;
        vertices_[slot] = vertex;
        rest_[slot] = body_->rest_position(vertex);
        gives_way_[static_cast<std::size_t>(slot)] = body_->gives_way(vertex);
        creeps_as_[slot] = body_->creep_of(vertex);
        known_[static_cast<std::size_t>(slot)] = false;
        for (std::int32_t loaded = 0; loaded < slot; ++loaded)
            if (known_[static_cast<std::size_t>(loaded)])
                set_block(slot, loaded,
                          growth(creeps_as_[slot], creeps_as_[loaded]) *
                              body_->compliance_between(vertex, vertices_[loaded]));
        held_moved_[slot] = displacement_under(held_, slot);
        leans_[slot] = leant_[slot] = lasting_[slot] = beyond_at(vertex);
        if (body_->creeps()) enter_creep(slot);
        held_moved_[slot] += lasting_[slot];
        measured_[slot] = before_[slot] = moved_[slot] =
            displacement_under(forces_, slot) + held_moved_[slot];
        for (Answer& answer : answers_) {
            answer.held_moved[slot] = displacement_under(answer.held, slot) + lasting_[slot];
            answer.moved[slot] = displacement_under(answer.forces, slot) + answer.held_moved[slot];
            answer.difference[slot].setZero();
        }
        if (kept_in_ != not_kept) before_[slot] = answers_[kept_in_].moved[slot];
    }
    seen_[slot] = tick_;
    return slot;
}

bool DeformedPatch::slots_of(std::int32_t triangle, std::array<std::int32_t, 3>& slots) noexcept {
    for (std::size_t corner = 0; corner < 3; ++corner) {
        slots[corner] = slot_of(body_->triangle(triangle)[corner]);
        if (slots[corner] == no_slot) return false;
    }
    return true;
}

collision::TriangleCorners DeformedPatch::look_at(std::int32_t triangle,
                                                  const Vector3d& sunk) const noexcept {
    collision::TriangleCorners met;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::int32_t vertex = body_->triangle(triangle)[i];
        met[i] = look_at_vertex(vertex);
        if (!body_->gives_way(vertex)) met[i] += sunk;
    }
    return met;
}

Vector3d DeformedPatch::look_at_vertex(std::int32_t vertex) const noexcept {
    const std::int32_t slot = slots_[vertex];
    if (slot != no_slot) return position(slot);
    Vector3d at = body_->rest_position(vertex) + beyond_at(vertex);
    const auto add = [&](std::int32_t loaded, const Vector3d& force) {
        at += (growth(body_->creep_of(vertex), creeps_as_[loaded]) *
               (body_->compliance_between(vertex, vertices_[loaded]) * force.cast<float>()))
                  .cast<double>();
    };
    for (const std::int32_t loaded : forces_.loaded) add(loaded, forces_.at[loaded] + held_.at[loaded]);
    for (const std::int32_t loaded : held_.loaded)
        if (!forces_.is_loaded[static_cast<std::size_t>(loaded)]) add(loaded, held_.at[loaded]);
    return at;
}

double DeformedPatch::farthest_from(const std::vector<Vector3d>& there) const noexcept {
    double most = 0;
    for (std::int32_t slot = 0; slot < size_; ++slot)
        most = std::max(most, (moved_[slot] - there[slot]).squaredNorm());
    return std::sqrt(most);
}

void DeformedPatch::measure_step() noexcept {
    step_ = farthest_from(measured_);
    std::copy_n(moved_.begin(), size_, measured_.begin());
}

Vector3d DeformedPatch::displacement_under(const Forces& forces, std::int32_t slot) const noexcept {
    Vector3d sum = Vector3d::Zero();
    for (const std::int32_t loaded : forces.loaded) sum += response(slot, loaded, forces.at[loaded]);
    return sum;
}

// The same for every slot.
void DeformedPatch::displace(const Forces& forces, std::vector<Vector3d>& moved) noexcept {
    std::fill_n(sum_.begin(), size_, Vector4f::Zero());
    // By twos: sums need not be written as often.
    const auto loaded = forces.loaded.begin();
    std::size_t k = 0;
    for (; k + 1 < forces.loaded.size(); k += 2) {
        const Vector3f force = forces.at[loaded[k]].cast<float>(),
                       other = forces.at[loaded[k + 1]].cast<float>();
        const Block *const rows = blocks_of(loaded[k]), *const others = blocks_of(loaded[k + 1]);
        for (std::int32_t slot = 0; slot < size_; ++slot)
            sum_[slot] += rows[slot] * force + others[slot] * other;
    }
    if (k < forces.loaded.size()) {
        const Vector3f force = forces.at[loaded[k]].cast<float>();
        const Block* const rows = blocks_of(loaded[k]);
        for (std::int32_t slot = 0; slot < size_; ++slot) sum_[slot] += rows[slot] * force;
    }
    for (std::int32_t slot = 0; slot < size_; ++slot) moved[slot] = sum_[slot].head<3>().cast<double>();
}

void DeformedPatch::begin_answer(std::size_t iterate) noexcept {
    answers_[iterate].forces.clear();
}

void DeformedPatch::load_answer(std::size_t iterate, std::int32_t slot, const Vector3d& force) noexcept {
    answers_[iterate].forces.add(slot, force);
}

double DeformedPatch::end_answer(std::size_t iterate) noexcept {
    Answer& answer = answers_[iterate];
    displace(answer.forces, answer.moved);
    flat(answer.moved) += flat(answer.held_moved);
    flat(answer.difference) = flat(answer.moved) - flat(moved_);
    return largest(flat(answer.difference));
}

double DeformedPatch::product_of_differences(std::size_t a, std::size_t b) const noexcept {
    return flat(answers_[a].difference).matrix().dot(flat(answers_[b].difference).matrix());
}

// The way from where vertices are to where a combination of answers has them.
auto DeformedPatch::way_from(const std::vector<Vector3d>& from,
                             const std::array<double, iterates>& weights) const noexcept {
    auto way = flat(way_);
    way = -flat(from);
    for (std::size_t k = 0; k < iterates; ++k)
        if (weights[k] != 0) way += weights[k] * flat(answers_[k].moved);
    return way;
}

double DeformedPatch::departure(const std::array<double, iterates>& weights,
                                std::size_t from) const noexcept {
    return largest(way_from(answers_[from].moved, weights));
}

double DeformedPatch::way_to(const std::array<double, iterates>& weights) const noexcept {
    return largest(way_from(moved_, weights));
}

double DeformedPatch::along(const std::array<double, iterates>& weights, std::size_t iterate) const noexcept {
    return way_from(moved_, weights).matrix().dot(flat(answers_[iterate].difference).matrix());
}

// A part `step` of the way from the state's forces to a combination of the answers'.
void DeformedPatch::combine(Forces& state, Forces Answer::*part, const std::array<double, iterates>& weights,
                            double step) noexcept {
    if (step < 1)
        for (const std::int32_t slot : state.loaded) state.at[slot] *= 1 - step;
    else
        state.clear();
    for (std::size_t k = 0; k < iterates; ++k) {
        if (weights[k] == 0) continue;
        const Forces& forces = answers_[k].*part;
        for (const std::int32_t slot : forces.loaded) state.add(slot, step * weights[k] * forces.at[slot]);
    }
    const auto bears_none = [&](std::int32_t slot) {
        const bool none = state.at[slot] == Vector3d::Zero();
        if (none) state.is_loaded[static_cast<std::size_t>(slot)] = false;
        return none;
    };
    state.loaded.erase_if(bears_none);
}

void DeformedPatch::relax_to(const std::array<double, iterates>& weights, double step) noexcept {
    combine(forces_, &Answer::forces, weights, step);
    combine(held_, &Answer::held, weights, step);
    const auto go = [&](std::vector<Vector3d>& state, std::vector<Vector3d> Answer::*part) {
        bool from_state = step < 1;
        if (from_state) flat(state) *= 1 - step;
        for (std::size_t k = 0; k < iterates; ++k) {
            if (weights[k] == 0) continue;
            if (from_state)
                flat(state) += step * weights[k] * flat(answers_[k].*part);
            else
                flat(state) = weights[k] * flat(answers_[k].*part);
            from_state = true;
        }
    };
    go(moved_, &Answer::moved);
    go(held_moved_, &Answer::held_moved);
}

void DeformedPatch::keep_hold(std::size_t iterate) noexcept {
    Answer& answer = answers_[iterate];
    answer.held.take(held_);
    std::copy_n(held_moved_.begin(), size_, answer.held_moved.begin());
}

void DeformedPatch::keep_state(std::size_t iterate) noexcept {
    kept_in_ = iterate;
    keep_hold(iterate);
    answers_[iterate].forces.take(forces_);
    std::copy_n(moved_.begin(), size_, answers_[iterate].moved.begin());
}

void DeformedPatch::begin_hold(std::size_t iterate) noexcept {
    answers_[iterate].held.clear();
}

void DeformedPatch::hold(std::size_t iterate, std::int32_t slot, const Vector3d& force) noexcept {
    answers_[iterate].held.add(slot, force);
}

void DeformedPatch::end_hold(std::size_t iterate) noexcept {
    Answer& answer = answers_[iterate];
    displace(answer.held, answer.held_moved);
    if (!body_->creeps() && shape_ == nullptr) return;
    for (std::int32_t slot = 0; slot < size_; ++slot) answer.held_moved[slot] += lasting_[slot];
}

}  // namespace palpate::haptics
