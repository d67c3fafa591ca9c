// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/records/tick_result.hpp"
#include "runtime/haptics/contact/contact_bodies.hpp"
#include "runtime/haptics/contact/equilibrium/deformed_patch.hpp"
#include "runtime/haptics/contact/fixed_list.hpp"

namespace palpate::haptics {

/// Contact of deformable bodies with the bodies beside them, while tools push them: the rows that this adds
/// to the tools' complementarity problem. The equations stand in neighbour_contact.cpp. Candidates are the
/// vertices that are near another body at rest. Each is looked at once the surfaces have gone so far that it
/// could have come near, at the latest after 10 ms: in the tick and in turn, since that costs less than the
/// copies that another thread would need, a replay does the same again, and nothing is seen late. One thread;
/// all but the constructor is realtime-safe.
class NeighbourContact {
  public:
    static constexpr std::size_t most_rows = 48;
    /// What surfaces may overlap unnoticed, and are apart at the least before they press, mm.
    static constexpr double slight_gap = 0.05;

    /// `bodies` must outlive this. Two queries per vertex and body beside it.
    explicit NeighbourContact(const ContactBodies& bodies);

    /// How many vertices may meet another body.
    std::size_t candidate_count() const noexcept { return probes_.size(); }
    /// Forgets what was near, as if all bodies were at rest.
    void forget() noexcept;

    /// Starts a tick: looks which candidates are near where the surfaces are. `patches`: of the deformable
    /// bodies, here and in what follows.
    void look(std::span<const DeformedPatch> patches) noexcept;
    /// Finds the rows about the present displacements, no more than `room`, where those that there are do not
    /// do any more: in the first call of a tick, and once surfaces have moved on.
    void gather(std::span<DeformedPatch> patches, std::size_t room) noexcept;
    /// Says that surfaces have moved by so much, mm.
    void move(double way) noexcept;

    std::size_t row_count() const noexcept { return rows_.size(); }
    /// Of row k: what forces must open, mm, and whether it pressed in the last solution.
    double gap(std::size_t k) const noexcept { return rows_[k].gap; }
    bool is_active(std::size_t k) const noexcept { return probe_of(rows_[k]).pressed == rows_[k].triangle; }
    /// How far each row opens per force of row l, mm/N; worked out once for rows as they are.
    std::span<const double> compliances(std::span<const DeformedPatch> patches, std::size_t l) noexcept;
    /// How far row k closes if `patch` is displaced so, mm.
    double closing(std::size_t k, std::int32_t patch, const DeformedPatch::Field& moved) const noexcept;
    /// How far row k opens per force with which a tool pushes `patch` along -normal, mm/N.
    double compliance_to_tool(std::span<const DeformedPatch> patches, std::size_t k, std::int32_t patch,
                              const std::array<std::int32_t, 3>& slots, const Eigen::Vector3d& weights,
                              const Eigen::Vector3d& normal) const noexcept;
    /// The solution: forces of all rows, N.
    void take(std::span<const double> forces) noexcept;
    /// Adds the rows' forces to an answer.
    void load_answer(std::span<DeformedPatch> patches, std::size_t iterate) const noexcept;
    /// Whether the state keeps clear of what was near, but not solved, to first order. If not, rows are found
    /// anew.
    bool is_clear(std::span<const DeformedPatch> patches) noexcept;
    /// Whether bodies overlap where no row was left for it.
    bool was_cut() const noexcept { return cut_; }
    /// Appends the contacts that press.
    void write_contacts(TickResult& result) const noexcept;
    void end_tick(std::span<const DeformedPatch> patches) noexcept;

  private:
    static constexpr std::size_t most_near = 96, most_walked = 32;

    // One deformable body and one beside it.
    struct Interface {
        std::int32_t soft = 0;                     // patch of the candidates
        std::int32_t other = -1;                   // patch of the triangles; -1: rigid
        std::int32_t body = 0;                     // of the triangles
        std::size_t first = 0, end = 0, next = 0;  // candidates, and the one to look at next
        double way = 0, motion = 0;                // mm, that the surfaces went: so far, and in the last tick
        // Of a rigid body: across the edges of its triangles, and where they are in its tree.
        std::vector<std::array<std::int32_t, 3>> neighbours;
        std::vector<std::int32_t> tree_slots;
    };
    // A triangle that is the nearest.
    struct Place {
        std::int32_t triangle = 0, tree_slot = 0;
        std::int32_t vertex = 0;  // its nearest
    };
    // A candidate: a vertex with a ball behind it.
    struct Probe {
        std::size_t interface = 0;
        std::int32_t vertex = 0;
        Eigen::Vector3d arm = Eigen::Vector3d::Zero();  // from the vertex to the ball's centre, mm
        double radius = 0;
        Place at_rest, place;
        double gap_at_rest = 0, gap = 0;                 // mm
        double due = 0;                                  // of the way
        double seen_way = 0;                             // when it was looked at last, and where it was
        Eigen::Vector3d seen = Eigen::Vector3d::Zero();  // then, against the other body, mm
        double mobility = 1;  // how much it goes of what the fastest place does, at the most
        bool near = false;
        std::int32_t pressed = -1;  // the triangle that it pressed last
        double opens = 0;           // mm, by that alone
    };
    struct Row {
        std::size_t probe = 0;
        std::int32_t triangle = 0, slot = 0;
        std::array<std::int32_t, 3> slots{};  // of the other body; nothing of a rigid one
        Eigen::Vector3d weights = Eigen::Vector3d::Zero(), point = Eigen::Vector3d::Zero();
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // from the triangle's body to the vertex's
        double distance = 0, gap = 0, force = 0;           // mm, mm, N
        double worth = 0;                                  // mm, that it would overlap without a row
    };
    struct Seen {
        std::int32_t triangle = 0;
        std::array<std::int32_t, 3> slots{};
        collision::TriangleCorners corners;
        collision::TrianglePoint closest;
        double distance = 0;
    };
    using Walked = FixedList<Seen, most_walked>;

    const Probe& probe_of(const Row& row) const noexcept { return probes_[row.probe]; }
    const Interface& interface_of(const Row& row) const noexcept {
        return interfaces_[probe_of(row).interface];
    }
    void add_interface(std::size_t soft, std::size_t body, const Eigen::AlignedBox3d& box, double reach);
    static double ahead_of(const Probe& probe, const Interface& interface) noexcept;
    bool look_at(Probe& probe, std::span<const DeformedPatch> patches) noexcept;
    bool corners_of(const Interface& interface, std::span<DeformedPatch> patches, std::int32_t triangle,
                    std::array<std::int32_t, 3>& slots, collision::TriangleCorners& corners) const noexcept;
    Walked walk(const Interface& interface, std::span<DeformedPatch> patches, std::int32_t from,
                const Eigen::Vector3d& centre) const noexcept;
    void meet(std::size_t probe, std::span<DeformedPatch> patches) noexcept;
    void cut_rows(std::size_t room) noexcept;
    void add_compliance(std::span<const DeformedPatch> patches, std::int32_t patch, std::size_t l,
                        const std::array<std::int32_t, 3>& loaded, const Eigen::Vector3d& shares,
                        const Eigen::Vector3d& force) noexcept;
    // By how much what is not held parts row's bodies, mm.
    double parted(const Row& row, std::span<const DeformedPatch> patches) const noexcept;

    const ContactBodies& bodies_;
    std::vector<Interface> interfaces_;
    std::vector<Probe> probes_;
    FixedList<std::size_t, most_near> near_;
    FixedList<Row, 2 * most_near> rows_, watched_;
    Eigen::Matrix<double, most_rows, most_rows> compliance_;  // of rows_,
    std::bitset<most_rows> known_;                            // by columns
    bool cut_ = false;
    bool stale_ = true;  // rows_
    double moved_ = 0;   // mm, since they were found
};

}  // namespace palpate::haptics
