// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bitset>
#include <cstdint>
#include <ranges>
#include <vector>

#include "runtime/collision/rounded_triangle.hpp"
#include "runtime/haptics/contact/deformable_contact.hpp"
#include "runtime/haptics/contact/fixed_list.hpp"
#include "runtime/haptics/contact/large_shape.hpp"

namespace palpate::haptics {

inline constexpr double same_place = 1e-6;  ///< mm: closest points nearer than this are one

/// The part of a deformable body's surface that tools are near, as it is displaced: its vertices, the nodal
/// forces on them, and their blocks of the compliance, which are read once and stay while they are needed:
/// those by which a vertex displaces others when it is first pressed. Vertices are known by their slots,
/// which stay the same within a tick. Where tissue creeps, vertices stay while what pressed them has left a
/// dent, and the blocks are those of a tick: deformed_patch_creep.cpp. Allocates on construction only.
class DeformedPatch {
  public:
    static constexpr std::int32_t most_vertices = 256;
    static constexpr std::size_t iterates = 11;

    /// `body` must outlive this.
    explicit DeformedPatch(const DeformableContact& body);

    const DeformableContact& body() const noexcept { return *body_; }

    /// Forgets all vertices and forces, and what came before.
    void reset() noexcept;
    /// Forgets the forces, and all else but for what they leave behind where tissue creeps.
    void release() noexcept;
    /// Starts a tick: the displacements so far are those before it, what creeps goes on by a tick, and
    /// vertices that nobody has looked at for some time go.
    void begin_tick() noexcept;

    /// From now on the tissue leans on a shape of large deformation, which must outlive that; null: on none.
    void take_shape(const LargeShape* shape) noexcept;
    /// Calls `take` with each vertex and what presses it, N; a vertex may come twice.
    template <typename Take>
    void each_force(const Take& take) const noexcept {
        for (const Forces* forces : {&forces_, &held_})
            for (const std::int32_t slot : forces->loaded) take(vertices_[slot], forces->at[slot]);
    }

    /// The slots of a triangle's corners, which come in if they are new; false where there is no room left.
    bool slots_of(std::int32_t triangle, std::array<std::int32_t, 3>& slots) noexcept;
    /// The slot of a vertex, which comes in if it is new; negative where there is no room left.
    std::int32_t slot_of(std::int32_t vertex) noexcept;
    bool is_in(std::int32_t vertex) const noexcept { return slots_[vertex] != no_slot; }
    /// How many vertices more may come in.
    std::int32_t room() const noexcept { return most_vertices - size_; }
    /// The met_corners() of a triangle, whether its vertices are in or not: for a look from time to time.
    collision::TriangleCorners look_at(std::int32_t triangle, const Eigen::Vector3d& sunk) const noexcept;
    /// Where a vertex is, likewise.
    Eigen::Vector3d look_at_vertex(std::int32_t vertex) const noexcept;
    bool bears_force() const noexcept { return !forces_.loaded.empty(); }
    /// Whether nothing is known of it but its rest.
    bool is_at_rest() const noexcept { return size_ == 0; }
    /// The most that any vertex has moved since this tick began, mm.
    double motion() const noexcept { return farthest_from(before_); }
    /// Measures the most that any vertex has moved since this was measured last: step(), mm.
    void measure_step() noexcept;
    double step() const noexcept { return step_; }

    /// Where the corners of a triangle are, p_P, mm.
    collision::TriangleCorners corners(const std::array<std::int32_t, 3>& slots) const noexcept {
        return {position(slots[0]), position(slots[1]), position(slots[2])};
    }
    /// Where a sphere that has sunk in by `sunk` (mm) meets them: it does not sink into what does not give
    /// way.
    collision::TriangleCorners met_corners(const std::array<std::int32_t, 3>& slots,
                                           const Eigen::Vector3d& sunk) const noexcept {
        collision::TriangleCorners met = corners(slots);
        for (std::size_t i = 0; i < 3; ++i)
            if (!gives_way(slots[i])) met[i] += sunk;
        return met;
    }
    /// What a sphere meets of a triangle whose met_corners() are these: it is round at its edges.
    collision::RoundedTriangle rounded(std::int32_t triangle,
                                       const collision::TriangleCorners& met) const noexcept {
        collision::RoundedTriangle round{.centres = met, .radii = {}};
        for (std::size_t i = 0; i < 3; ++i) {
            const InnerBall& ball = body_->inner_ball(body_->triangle(triangle)[i]);
            round.centres[i] += ball.inset;
            round.radii[static_cast<Eigen::Index>(i)] = ball.radius;
        }
        return round;
    }
    bool gives_way(std::int32_t slot) const noexcept { return gives_way_[static_cast<std::size_t>(slot)]; }
    /// Where a vertex is, p_P, mm.
    Eigen::Vector3d position(std::int32_t slot) const noexcept { return rest_[slot] + moved_[slot]; }
    /// By how much a vertex is displaced, mm: now, before this tick, and by the forces held alone with what
    /// earlier ones left behind.
    const Eigen::Vector3d& displacement(std::int32_t slot) const noexcept { return moved_[slot]; }
    const Eigen::Vector3d& displacement_before(std::int32_t slot) const noexcept { return before_[slot]; }
    const Eigen::Vector3d& held_displacement(std::int32_t slot) const noexcept { return held_moved_[slot]; }
    /// What a force (N) on one vertex displaces another by within a tick, mm.
    Eigen::Vector3d response(std::int32_t slot, std::int32_t loaded,
                             const Eigen::Vector3d& force) const noexcept {
        const Eigen::Vector4f moved = block(slot, loaded) * force.cast<float>();
        return moved.head<3>().cast<double>();
    }

    /// By how much each vertex is displaced, by slot, mm.
    using Field = std::array<Eigen::Vector4f, static_cast<std::size_t>(most_vertices)>;
    /// Writes what a force (N), shared out to three vertices, displaces each vertex by.
    void yield(const std::array<std::int32_t, 3>& loaded, const Eigen::Vector3d& shares,
               const Eigen::Vector3d& force, Field& moved) const noexcept {
        yield(loaded, shares, force, std::views::iota(0, size_), moved);
    }
    /// The same for some of the slots; numbers beyond those that there are do not count.
    void yield(const std::array<std::int32_t, 3>& loaded, const Eigen::Vector3d& shares,
               const Eigen::Vector3d& force, const auto& slots, Field& moved) const noexcept {
        const std::array<const Block*, 3> rows{blocks_of(loaded[0]), blocks_of(loaded[1]),
                                               blocks_of(loaded[2])};
        const Eigen::Matrix3f forces = force.cast<float>() * shares.cast<float>().transpose();
        for (const std::int32_t slot : slots)
            if (slot < size_)
                moved[static_cast<std::size_t>(slot)] = rows[0][slot] * forces.col(0) +
                                                        rows[1][slot] * forces.col(1) +
                                                        rows[2][slot] * forces.col(2);
    }
    /// The same of a force shared out to any number of vertices, `bearings` of a slot and its share each.
    void yield(const auto& bearings, const Eigen::Vector3d& force, Field& moved) const noexcept {
        std::fill_n(moved.begin(), size_, Eigen::Vector4f::Zero());
        for (const auto& [loaded, share] : bearings) {
            const Block* const rows = blocks_of(loaded);
            const Eigen::Vector3f part = (share * force).template cast<float>();
            for (std::int32_t slot = 0; slot < size_; ++slot)
                moved[static_cast<std::size_t>(slot)] += rows[slot] * part;
        }
    }
    /// The mean of a field over three vertices.
    static Eigen::Vector3d mean(const Field& moved, const std::array<std::int32_t, 3>& slots,
                                const Eigen::Vector3d& shares) noexcept {
        const Eigen::Vector3f weights = shares.cast<float>();
        const Eigen::Vector4f sum = weights[0] * moved[static_cast<std::size_t>(slots[0])] +
                                    weights[1] * moved[static_cast<std::size_t>(slots[1])] +
                                    weights[2] * moved[static_cast<std::size_t>(slots[2])];
        return sum.head<3>().cast<double>();
    }

    /// What a force (N), shared out to three vertices, displaces another by, mm. Shares that are not positive
    /// do not count.
    Eigen::Vector3f yielding(std::int32_t slot, const std::array<std::int32_t, 3>& loaded,
                             const Eigen::Vector3d& shares, const Eigen::Vector3d& force) const noexcept {
        Eigen::Vector4f moved = Eigen::Vector4f::Zero();
        for (std::size_t j = 0; j < 3; ++j)
            if (const double share = shares[static_cast<Eigen::Index>(j)]; share > 0)
                moved += block(slot, loaded[j]) * (share * force).cast<float>();
        return moved.head<3>();
    }

    /// One of `iterates` answers to a state of forces and displacements: the forces that contact
    /// answers it with, and what they displace. Collects forces, N, then works out displacements and returns
    /// the largest by which they differ from the state, mm.
    void begin_answer(std::size_t iterate) noexcept;
    void load_answer(std::size_t iterate, std::int32_t slot, const Eigen::Vector3d& force) noexcept;
    double end_answer(std::size_t iterate) noexcept;
    /// Inner product of the differences of two answers from their states, mm².
    double product_of_differences(std::size_t a, std::size_t b) const noexcept;
    /// How far a combination of answers is from one of them, mm.
    double departure(const std::array<double, iterates>& weights, std::size_t from) const noexcept;
    /// How far any vertex is from where a combination of answers has it, mm.
    double way_to(const std::array<double, iterates>& weights) const noexcept;
    /// Inner product of the way to a combination of answers with an answer's difference from the state, mm².
    double along(const std::array<double, iterates>& weights, std::size_t iterate) const noexcept;
    /// Keeps the state in which a tick begins as if it were an answer to itself.
    void keep_state(std::size_t iterate) noexcept;
    /// Moves the state a part `step` of the way to a combination of answers, weights summing to 1.
    void relax_to(const std::array<double, iterates>& weights, double step) noexcept;

    /// Of the answer that comes next, the forces that stay as they are while contact is solved, as
    /// friction's, N: those of the state, or others, which are collected.
    void keep_hold(std::size_t iterate) noexcept;
    void begin_hold(std::size_t iterate) noexcept;
    void hold(std::size_t iterate, std::int32_t slot, const Eigen::Vector3d& force) noexcept;
    void end_hold(std::size_t iterate) noexcept;

  private:
    static constexpr std::int32_t no_slot = -1;
    // Three columns of four, of which the last does nothing: as processors have them.
    using Block = Eigen::Matrix<float, 4, 3>;

    // A sparse field of forces on vertices.
    struct Forces {
        std::vector<Eigen::Vector3d> at;  // by slot
        // Slots with a force.
        FixedList<std::int32_t, static_cast<std::size_t>(most_vertices)> loaded;
        std::bitset<static_cast<std::size_t>(most_vertices)> is_loaded;
        explicit Forces(std::size_t slots) : at(slots, Eigen::Vector3d::Zero()) {}
        void clear() noexcept;
        void add(std::int32_t slot, const Eigen::Vector3d& force) noexcept;
        void take(const Forces& other) noexcept;  // instead of its own
        void drop(std::int32_t slot) noexcept;
        void move(std::int32_t from, std::int32_t to) noexcept;  // which bears nothing
    };
    struct Answer {
        Forces forces, held;
        std::vector<Eigen::Vector3d> moved, held_moved, difference;
        explicit Answer(std::size_t slots)
            : forces(slots), held(slots), moved(slots), held_moved(slots), difference(slots) {}
        void clear() noexcept {
            forces.clear();
            held.clear();
        }
    };

    const Block& block(std::int32_t slot, std::int32_t loaded) const noexcept {
        return blocks_of(loaded)[slot];
    }
    // Of a force on a slot, by the slots that it displaces; read from C when it is first asked for.
    const Block* blocks_of(std::int32_t loaded) const noexcept {
        if (!known_[static_cast<std::size_t>(loaded)]) know(loaded);
        return &blocks_[static_cast<std::size_t>(loaded * most_vertices)];
    }
    void know(std::int32_t loaded) const noexcept;
    void set_block(std::int32_t slot, std::int32_t loaded, const Eigen::Matrix3f& compliance) const noexcept;
    void drop(std::int32_t slot) noexcept;
    void drop_one() noexcept;
    // In deformed_patch_large.cpp.
    double load() const noexcept;
    void lean() noexcept;
    Eigen::Vector3d beyond_at(std::int32_t vertex) const noexcept {
        if (shape_ == nullptr) return Eigen::Vector3d::Zero();
        return part_ * shape_->beyond[static_cast<std::size_t>(vertex)].cast<double>();
    }
    // In deformed_patch_creep.cpp.
    void creep() noexcept;
    void add_lasting(std::int32_t slot, const Eigen::Vector3d& more) noexcept;
    void enter_creep(std::int32_t slot) noexcept;
    double dent_at(std::int32_t slot) const noexcept;
    float growth(const TickCreep* a, const TickCreep* b) const noexcept {
        return a != nullptr && a == b ? static_cast<float>(a->now) : 1.0F;
    }
    double farthest_from(const std::vector<Eigen::Vector3d>& there) const noexcept;
    // What vertices have, by slot, as one array.
    auto flat(std::vector<Eigen::Vector3d>& by_slot) const noexcept {
        return Eigen::Map<Eigen::ArrayXd>(by_slot.front().data(), Eigen::Index{3} * size_);
    }
    auto flat(const std::vector<Eigen::Vector3d>& by_slot) const noexcept {
        return Eigen::Map<const Eigen::ArrayXd>(by_slot.front().data(), Eigen::Index{3} * size_);
    }
    static double largest(const auto& array) noexcept {
        return array.size() > 0 ? array.abs().maxCoeff() : 0;
    }
    auto way_from(const std::vector<Eigen::Vector3d>& from,
                  const std::array<double, iterates>& weights) const noexcept;
    Eigen::Vector3d displacement_under(const Forces& forces, std::int32_t slot) const noexcept;
    void combine(Forces& state, Forces Answer::*part, const std::array<double, iterates>& weights,
                 double step) noexcept;
    void displace(const Forces& forces, std::vector<Eigen::Vector3d>& moved) noexcept;

    const DeformableContact* body_;
    std::vector<std::int32_t> slots_;     // of each surface vertex
    std::vector<std::int32_t> vertices_;  // this and what follows by slot
    std::vector<Eigen::Vector3d> rest_, moved_, before_, measured_, held_moved_;
    double step_ = 0;
    static constexpr std::size_t not_kept = iterates;
    std::size_t kept_in_ = not_kept;  // the answer that has the state in which this tick began
    std::bitset<static_cast<std::size_t>(most_vertices)> gives_way_;
    std::vector<std::int64_t> seen_;  // the tick in which it was looked at last
    std::vector<Eigen::Vector4f> sum_;
    mutable std::vector<Eigen::Vector3d> way_;  // what way_from() worked out last
    // Rows by loaded slot, and which of them are there.
    mutable std::vector<Block> blocks_;
    mutable std::bitset<static_cast<std::size_t>(most_vertices)> known_;
    Forces forces_, held_;
    std::vector<Answer> answers_;
    std::int32_t size_ = 0;
    std::int64_t tick_ = 0;
    // Large deformation: the shape on which it leans, how much of that shape's load there is and how much of
    // it counts; by slot, how far it displaces beyond the compliance now and did when it came, mm.
    const LargeShape* shape_ = nullptr;
    double load_ = 0, part_ = 0;
    int leaning_ticks_ = 0;
    std::vector<Eigen::Vector3d> leans_, leant_;
    // Creep, by slot: as what, what is left of the forces on it and of its displacement, and what of that
    // lasts, with what it leans, mm.
    std::vector<const TickCreep*> creeps_as_;
    std::vector<CreepHistory> left_forces_, left_moves_;
    std::vector<Eigen::Vector3d> lasting_;
    bool remembers_ = false;        // loads,
    std::int64_t last_loaded_ = 0;  // of which the last was in this tick
};

}  // namespace palpate::haptics
