// SPDX-License-Identifier: Apache-2.0
// Tools that turn by themselves: their arms and levers, and how forces turn them; part of the tick.
#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"

namespace palpate::haptics {

using Eigen::Index;
using Eigen::Vector3d;

// Turns the tool's frame and the spheres' arms as the tool is turned.
void ContactEquilibrium::swing(Tool& tool) noexcept {
    const double angle = tool.turn.norm();
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    if (angle > 0) R = Eigen::AngleAxisd(angle, tool.turn / angle).toRotationMatrix();
    tool.R_PT = R * tool.on_device;
    for (Part& part : tool.parts) part.swung = R * part.arm;
}

bool ContactEquilibrium::stay(std::size_t t, const Vector3d& tip) noexcept {
    Tool& tool = tools_[t];
    if (tool.was_felt == 0) return false;
    forget(t);
    tool.off = tip - tool.tip;
    const Eigen::AngleAxisd turned(Eigen::Matrix3d(tool.last_R_PT * tool.on_device.transpose()));
    tool.turn = turned.angle() * turned.axis();
    swing(tool);
    return true;
}

// Takes the arms as a tool's device has them.
void ContactEquilibrium::pull_arms(Tool& tool) noexcept {
    tool.longest_arm = 0;
    for (Part& part : std::span(tool.parts).first(tool.felt)) {
        part.arm = part.sphere.device - tool.tip;
        tool.longest_arm = std::max(tool.longest_arm, part.arm.norm());
    }
    swing(tool);
}

void ContactEquilibrium::find_levers() noexcept {
    for (std::size_t k = 0; k < rows_.size(); ++k)
        levers_[k] = part_of(rows_[k]).swung.cross(rows_[k].normal);
}

// By how much more a force of one row opens the others of its tool, for it turns the tool.
void ContactEquilibrium::add_levers(std::size_t column) noexcept {
    for (std::size_t k = 0; k < rows_.size(); ++k)
        if (rows_[k].tool == rows_[column].tool)
            lcp_.matrix()(static_cast<Index>(k), static_cast<Index>(column)) +=
                torsion_ * levers_[k].dot(levers_[column]);
}

// How the present forces turn the tools; returns by how much that differs from how they are, mm of their
// farthest spheres.
double ContactEquilibrium::answer_turns(std::size_t iterate) noexcept {
    for (Tool& tool : tools_) tool.next_turn[iterate] = tool.kept_turn;
    for (std::size_t k = 0; k < rows_.size(); ++k)
        tools_[static_cast<std::size_t>(rows_[k].tool)].next_turn[iterate] +=
            torsion_ * rows_[k].force * levers_[k];
    double change = 0;
    for (Tool& tool : tools_) {
        if (friction_.any())
            for (const Part& part : tool.parts)
                for (const Hold& hold : part.holds)
                    tool.next_turn[iterate] +=
                        torsion_ * rubbing_arm(part, hold).cross(hold.next_drag[iterate]);
        if (tool.felt == 0) tool.turn = tool.next_turn[iterate];
        tool.turn_difference[iterate] = tool.next_turn[iterate] - tool.turn;
        change = std::max(change, tool.longest_arm * tool.turn_difference[iterate].lpNorm<Eigen::Infinity>());
    }
    return turn_change_ = change;
}

// A tool pushed along its shaft onto its end falls over where its spring does not hold it: by F l / kappa >
// 1, as a column buckles, answers lead away from each other, and the next equilibrium is far. It turns there
// over several ticks, against 1/2 c |theta - theta_before|² besides, c = 2 F l, as if something viscous held
// it: so each has an answer near, on this side of all walls, and the way there takes energy and gives none.
void ContactEquilibrium::resist_turning() noexcept {
    resists_turning_ = true;
    bank_ = in_row_ = carried_ = 0;
    double push_by_length = 0;
    for (const Tool& tool : tools_)
        push_by_length = std::max(push_by_length, tool.press.norm() * tool.longest_arm);
    const double resistance = 2 * push_by_length,
                 freely = std::exchange(torsion_, 1 / (1 / torsion_ + resistance));
    for (Tool& tool : tools_) {
        tool.kept_turn = (1 - torsion_ / freely) * tool.turn_before;
        tool.turn = tool.turn_before;
        swing(tool);
        tool.unpressed_turn = turn_by_drags(tool);
    }
}

// How a tool is turned by what it keeps and by friction.
Vector3d ContactEquilibrium::turn_by_drags(const Tool& tool) const noexcept {
    Vector3d turn = tool.kept_turn;
    if (friction_.any())
        for (const Part& part : tool.parts)
            for (const Hold& hold : part.holds) turn += torsion_ * rubbing_arm(part, hold).cross(hold.drag);
    return turn;
}

// Goes to a combination of answers, after the drags have.
void ContactEquilibrium::relax_turn(Tool& tool, const Weights& weights, double step) const noexcept {
    tool.turn += step * (combined(weights, tool.next_turn) - tool.turn);
    swing(tool);
    tool.unpressed_turn = turn_by_drags(tool);
}

}  // namespace palpate::haptics
