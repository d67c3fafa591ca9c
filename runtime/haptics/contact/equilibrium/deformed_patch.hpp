// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/collision/triangle_queries.hpp"
#include "runtime/haptics/contact/deformable_contact.hpp"
#include "runtime/haptics/contact/fixed_list.hpp"

namespace palpate::haptics {

/// The part of a deformable body's surface that tools are near, as it is displaced: its vertices, the nodal
/// forces on them, and their blocks of the compliance, which are read once when a vertex comes in and stay
/// while it is needed. Vertices are known by their slots, 0 ... size() - 1. Allocates on construction only.
class DeformedPatch {
  public:
    static constexpr std::int32_t most_vertices = 256;
    static constexpr std::size_t iterates = 3;

    /// `body` must outlive this.
    explicit DeformedPatch(const DeformableContact& body);

    const DeformableContact& body() const noexcept { return *body_; }

    /// Forgets all vertices and forces.
    void reset() noexcept;
    /// Starts a tick: the displacements so far are those before it, and vertices that were neither looked at
    /// in the last tick nor bear force go when room is needed.
    void begin_tick() noexcept;

    /// The slots of a triangle's corners, which come in if they are new; false where there is no room left.
    bool slots_of(std::int32_t triangle, std::array<std::int32_t, 3>& slots) noexcept;
    /// Where a triangle's corners are, p_P, mm, whether its vertices are in or not: for a look from time to
    /// time.
    collision::TriangleCorners look_at(std::int32_t triangle) const noexcept;
    bool bears_force() const noexcept { return !forces_.loaded.empty(); }
    /// Whether nothing is known of it but its rest.
    bool is_at_rest() const noexcept { return size_ == 0; }
    /// The most that any vertex looked at in this tick has moved since it began, mm.
    double motion() const noexcept;

    /// Where a vertex is, p_P, mm, and by how much it is displaced, now and before this tick.
    Eigen::Vector3d position(std::int32_t slot) const noexcept { return rest_[slot] + moved_[slot]; }
    const Eigen::Vector3d& displacement(std::int32_t slot) const noexcept { return moved_[slot]; }
    const Eigen::Vector3d& displacement_before(std::int32_t slot) const noexcept { return before_[slot]; }
    collision::TriangleCorners corners(const std::array<std::int32_t, 3>& slots) const noexcept {
        return {position(slots[0]), position(slots[1]), position(slots[2])};
    }

    /// The displacement of one vertex per force on another, mm/N, times a force.
    Eigen::Vector3d response(std::int32_t slot, std::int32_t loaded,
                             const Eigen::Vector3d& force) const noexcept {
        return (block(slot, loaded) * force.cast<float>()).cast<double>();
    }

    /// One of the last `iterates` answers to a state of forces and displacements: the forces that contact
    /// answers it with, and what they displace. Collects forces, N, then works out displacements and returns
    /// the largest by which they differ from the state, mm.
    void begin_answer(std::size_t iterate) noexcept;
    void load_answer(std::size_t iterate, std::int32_t slot, const Eigen::Vector3d& force) noexcept;
    double end_answer(std::size_t iterate) noexcept;
    /// Inner product of the differences of two answers from their states, mm².
    double product_of_differences(std::size_t a, std::size_t b) const noexcept;
    /// Moves the state a part `step` of the way to a combination of answers, weights summing to 1.
    void relax_to(const std::array<double, iterates>& weights, double step) noexcept;

    /// Forces that stay as they are while contact is solved, as friction's, N.
    void clear_held() noexcept;
    void hold(std::int32_t slot, const Eigen::Vector3d& force) noexcept;
    /// What they alone displace a vertex by, mm.
    Eigen::Vector3d held_displacement(std::int32_t slot) const noexcept;

  private:
    static constexpr std::int32_t no_slot = -1;

    // A sparse field of forces on vertices.
    struct Forces {
        std::vector<Eigen::Vector3d> at;  // by slot
        // Slots with a force.
        FixedList<std::int32_t, static_cast<std::size_t>(most_vertices)> loaded;
        explicit Forces(std::size_t slots) : at(slots, Eigen::Vector3d::Zero()) {}
        void clear() noexcept;
        void drop(std::int32_t slot) noexcept;
        void add(std::int32_t slot, const Eigen::Vector3d& force) noexcept;
    };

    const Eigen::Matrix3f& block(std::int32_t a, std::int32_t b) const noexcept {
        return blocks_[static_cast<std::size_t>(a * most_vertices + b)];
    }
    Eigen::Vector3d displacement_under(const Forces& forces, std::int32_t slot) const noexcept;
    std::int32_t free_slot() noexcept;
    std::int32_t slot_of(std::int32_t vertex) noexcept;

    const DeformableContact* body_;
    std::vector<std::int32_t> slots_;  // of each surface vertex
    std::vector<std::int32_t> vertices_;
    std::vector<Eigen::Vector3d> rest_, moved_, before_;
    std::vector<std::int64_t> seen_;  // the tick in which it was looked at last
    std::vector<Eigen::Matrix3f> blocks_;
    struct Answer {
        Forces forces;
        std::vector<Eigen::Vector3d> moved, difference;
        explicit Answer(std::size_t slots) : forces(slots), moved(slots), difference(slots) {}
    };
    Forces forces_, held_, combined_;
    std::vector<Answer> answers_;
    std::int32_t size_ = 0;
    std::int64_t tick_ = 0;
};

}  // namespace palpate::haptics
