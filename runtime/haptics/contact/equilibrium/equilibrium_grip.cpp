// SPDX-License-Identifier: Apache-2.0
// What friction holds where several spheres hold the same tissue or hang on the same tool; part of the tick.
//
// The drags d and what presses are unknown together there:
//     w = A f - gaps >= 0, f >= 0, f . w = 0    for what presses, as without friction,
//     s + c d = 0                               for two directions d of each sphere that does not slide,
// with s and gaps linear in f and d by one symmetric matrix: a ContactLcp some of whose rows may pull. One
// that slides on a wall has its drag opposite to its slip, and as large as Coulomb has it: with a slip v and
// a drag d there, a slip s across turns the drag by -d s / v across, which is a row like those of what is
// held. Spheres of one tool hold each other much more stiffly than its coupling holds each, so that each by
// itself would not find its direction. On tissue all that is left to the search: what slides, and what lets
// go (rub()).
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"

namespace palpate::haptics {

using Eigen::Index;
using Eigen::Vector3d;

// Solves again what presses, with rows that hold each sphere along the surface. On walls as often as it takes
// to find which of them slide, the one first that is asked for most of what it bears. Where that goes round
// in circles, here or from answer to answer, as in a wedge, their drags are taken as they are by then, no
// larger than they can be: what presses them keeps them out of all walls.
void ContactEquilibrium::hold_together() noexcept {
    constexpr int most_rounds = 12, most_cuts = 16;
    const ContactLcp::Vector gaps = lcp_.gaps();
    for (Rubbing& rubbing : rubbing_) begin_hold(rubbing);
    if (std::ranges::none_of(rubbing_, &Rubbing::held)) return;
    for (int round = 0; round < most_rounds && may_change_grip_; ++round) {
        solve_held(gaps, true);
        if (!change_grip()) return;
    }
    cut_drags();
    for (int cut = 0; cut < most_cuts; ++cut) {
        solve_held(gaps, false);
        if (!cut_drags()) return;
    }
}

// Solves what presses and what holds, with the rows' gaps as without that; `walls`: also what is held on
// walls.
void ContactEquilibrium::solve_held(const ContactLcp::Vector& gaps, bool walls) noexcept {
    const auto n = static_cast<Index>(rows_.size() + neighbours_.row_count());
    ++solves_;
    tangents_.clear();
    for (Rubbing& rubbing : rubbing_) {
        const bool on_tissue = rubbing.group->patch >= 0;
        if (on_tissue && rubbing.held) begin_hold(rubbing);
        if (walls || on_tissue) add_tangents(rubbing);
    }
    lcp_.gaps().head(n) = gaps.head(n);
    for (std::size_t t = 0; t < tangents_.size(); ++t) fill_tangent(t);
    for (const Rubbing& rubbing : rubbing_) add_known_drag(rubbing);
    residual_ = lcp_.solve_with(static_cast<std::size_t>(n), tangents_.size(),
                                [&](std::size_t row) { fill_any_column(row); });
    for (std::size_t t = 0; t < tangents_.size(); ++t)
        tangents_[t].rubbing->drag += lcp_.forces()[n + static_cast<Index>(t)] * tangents_[t].along;
    take_forces();
    for (Rubbing& rubbing : rubbing_)
        if (measure_press(*rubbing.group)) find_bearings(*rubbing.group, rubbing.bearings);
}

// Cuts drags on walls to what friction bears there; tells whether any was larger.
bool ContactEquilibrium::cut_drags() noexcept {
    bool any = false;
    for (Rubbing& rubbing : rubbing_) {
        if (!rubbing.held || rubbing.group->patch >= 0) continue;
        Hold& hold = hold_of(*rubbing.group);
        const double drag = rubbing.drag.norm();
        if (!(drag > most_drag(*rubbing.group, hold.slid ? friction_.sliding : friction_.at_rest))) continue;
        const double most = most_drag(*rubbing.group, friction_.sliding);
        any = any || drag > most + coupling_ * settled;
        rubbing.drag *= most / drag;
        hold.slides = hold.slid = true;
        hold.slipping = 0;
    }
    return any;
}

// How far a sphere that pressed in the last tick has gone past what it holds if nothing pressed, with
// friction as it is, mm.
Vector3d ContactEquilibrium::free_slip_of(const Rubbing& rubbing) const noexcept {
    const Group& group = *rubbing.group;
    const Tool& tool = tools_[static_cast<std::size_t>(group.tool)];
    Vector3d slip = slip_before(group) + way_past(group) - (tool.off - tool.drag / coupling_);
    if (turns()) slip -= (tool.turn - tool.unpressed_turn).cross(rubbing_arm(part_of(group), hold_of(group)));
    for (const auto& [slot, share] : rubbing.bearings)
        slip -= share * (patch_of(group).held_displacement(slot) - patch_of(group).displacement_before(slot));
    return slip;
}

// What is known of a drag before it is solved with all others.
void ContactEquilibrium::begin_hold(Rubbing& rubbing) const noexcept {
    const Group& group = *rubbing.group;
    const Hold& hold = hold_of(group);
    rubbing.held = hold.pressed && (group.patch < 0 || !hold.slides);
    rubbing.drag = hold.drag - hold.axis.dot(hold.drag) * hold.axis;
}

// The directions in which a sphere is held. One that finds no room is left to itself.
void ContactEquilibrium::add_tangents(Rubbing& rubbing) noexcept {
    if (!rubbing.held || rubbing.let_go) return;
    rubbing.held = tangents_.size() + 2 <= ContactLcp::most_tangents;
    if (!rubbing.held) return;
    const Group& group = *rubbing.group;
    const Hold& hold = hold_of(group);
    const double shear = shearing(group), drag = rubbing.drag.norm();
    if (hold.slides) {
        if (!(drag > 0)) return;  // friction bears nothing there
        tangents_.push_back({&rubbing, hold.axis.cross(rubbing.drag / drag), shear + hold.slipping / drag});
        return;
    }
    const Vector3d along = hold.axis.unitOrthogonal();
    tangents_.push_back({&rubbing, along, shear});
    tangents_.push_back({&rubbing, hold.axis.cross(along), shear});
}

// How a drag on a sphere (N), and its opposite on the tissue, opens the rows and moves spheres past what they
// hold, mm: calls `take` with each in turn.
template <typename Take>
void ContactEquilibrium::each_opening(const Rubbing& rubbing, const Vector3d& drag,
                                      const Take& take) noexcept {
    const Group& group = *rubbing.group;
    const bool moves_tissue = group.patch >= 0;
    if (moves_tissue) patch_of(group).yield(rubbing.bearings, drag, field_);
    const Vector3d lever = rubbing_arm(part_of(group), hold_of(group)).cross(drag);
    const auto way_of = [&](const auto& other, const Vector3d& arm, const Vector3d& along) {
        if (other.tool != group.tool) return 0.0;
        const double turning = turns() ? torsion_ * lever.dot(arm.cross(along)) : 0;
        return along.dot(drag) / coupling_ + turning;
    };
    for (const Row& row : rows_) {
        double opens = way_of(row, part_of(row).swung, row.normal);
        if (moves_tissue && row.patch == group.patch)
            opens += row.normal.dot(DeformedPatch::mean(field_, row.slots, row.weights));
        take(opens);
    }
    for (std::size_t k = 0; k < neighbours_.row_count(); ++k)
        take(moves_tissue ? neighbours_.closing(k, group.patch, field_) : 0);
    for (const Tangent& tangent : tangents_) {
        const Group& other = *tangent.rubbing->group;
        double slips = way_of(other, rubbing_arm(part_of(other), hold_of(other)), tangent.along);
        if (moves_tissue && other.patch == group.patch)
            for (const auto& [slot, share] : tangent.rubbing->bearings) {
                const Vector3d moved = field_[static_cast<std::size_t>(slot)].head<3>().cast<double>();
                slips += share * tangent.along.dot(moved);
            }
        take(slips);
    }
}

// The column of the matrix, and its row, of a tangent; and what it has to make good.
void ContactEquilibrium::fill_tangent(std::size_t t) noexcept {
    const auto& [rubbing, along, gives] = tangents_[t];
    const auto column = static_cast<Index>(rows_.size() + neighbours_.row_count() + t);
    Index at = 0;
    each_opening(*rubbing, along, [&](double opens) {
        lcp_.matrix()(at, column) = lcp_.matrix()(column, at) = opens;
        ++at;
    });
    lcp_.matrix()(column, column) += gives;
    lcp_.gaps()[column] = -along.dot(free_slip_of(*rubbing) + gives * rubbing->drag);
}

// What of a drag on a wall is known, and differs from what the state has.
void ContactEquilibrium::add_known_drag(const Rubbing& rubbing) noexcept {
    const Vector3d known = rubbing.drag - hold_of(*rubbing.group).drag;
    if (!rubbing.held || rubbing.group->patch >= 0 || known.isZero(0)) return;
    Index at = 0;
    each_opening(rubbing, known, [&](double opens) { lcp_.gaps()[at++] -= opens; });
}

// Lets go of what nothing presses any more, and of what is pressed again takes hold anew; tells whether it
// did.
bool ContactEquilibrium::regrip(Rubbing& rubbing) noexcept {
    constexpr int most_regrips = 2;
    Hold& hold = hold_of(*rubbing.group);
    const bool presses = hold.press > 0;
    if (presses != rubbing.let_go || (presses && rubbing.regrips == most_regrips)) return false;
    if (presses) ++rubbing.regrips;
    rubbing.let_go = !presses;
    rubbing.drag.setZero();
    hold.slides = false;
    return true;
}

// Of what slides on a wall: goes on with as large a drag as it has then, or is held once it would go along
// with its drag; tells whether that changes anything.
bool ContactEquilibrium::go_on_sliding(Rubbing& rubbing) noexcept {
    Hold& hold = hold_of(*rubbing.group);
    const double drag = rubbing.drag.norm(), most = most_drag(*rubbing.group, friction_.sliding);
    const double back = slip_after(rubbing).dot(rubbing.drag) / drag;
    hold.slipping = std::max(0.0, -back);
    hold.slides = !(back > 0);
    if (!hold.slides) return true;
    rubbing.drag *= most / drag;
    return std::abs(drag - most) > coupling_ * settled;
}

// Has friction do what it can by the present forces, and of those that are held on walls the sphere slide
// that is asked for most of what it bears. Tells whether anything changes.
bool ContactEquilibrium::change_grip() noexcept {
    Rubbing* overdone = nullptr;
    double most = 1;
    bool changed = false;
    for (Rubbing& rubbing : rubbing_) {
        if (!rubbing.held || rubbing.group->patch >= 0) continue;
        changed = regrip(rubbing) || changed;
        if (rubbing.let_go || rubbing.drag.isZero(0)) continue;
        const Hold& hold = hold_of(*rubbing.group);
        if (hold.slides) {
            changed = go_on_sliding(rubbing) || changed;
            continue;
        }
        const double asked = rubbing.drag.norm() /
                             most_drag(*rubbing.group, hold.slid ? friction_.sliding : friction_.at_rest);
        if (!(asked > most)) continue;
        most = asked;
        overdone = &rubbing;
    }
    if (overdone == nullptr) return changed;
    Hold& hold = hold_of(*overdone->group);
    hold.slides = hold.slid = true;
    hold.slipping = 0;
    overdone->drag *= most_drag(*overdone->group, friction_.sliding) / overdone->drag.norm();
    return true;
}

// How far a sphere will have gone past its wall once its tool answers to the present forces, mm.
Vector3d ContactEquilibrium::slip_after(const Rubbing& rubbing) const noexcept {
    const Group& group = *rubbing.group;
    const Tool& tool = tools_[static_cast<std::size_t>(group.tool)];
    Vector3d force = Vector3d::Zero(), torque = Vector3d::Zero();
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        if (rows_[k].tool != group.tool) continue;
        force += rows_[k].force * rows_[k].normal;
        torque += rows_[k].force * levers_[k];
    }
    for (const Rubbing& other : rubbing_) {
        if (other.group->tool != group.tool) continue;
        force += other.drag;
        torque += rubbing_arm(part_of(*other.group), hold_of(*other.group)).cross(other.drag);
    }
    const Hold& hold = hold_of(group);
    const Vector3d turned = tool.kept_turn + torsion_ * torque - tool.turn;
    return slip_before(group) + way_past(group) + force / coupling_ - tool.off +
           turned.cross(rubbing_arm(part_of(group), hold));
}

}  // namespace palpate::haptics
