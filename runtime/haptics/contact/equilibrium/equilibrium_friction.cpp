// SPDX-License-Identifier: Apache-2.0
// Friction between tools and tissue, and between walls and tools that turn by themselves; part of the tick.
//
// Where a sphere presses, friction holds it and the tissue together: the drag d on the tool is what undoes
// the way s that they have gone past each other, along with the coupling and the tissue's own compliance,
// until that is more than there can be: most_drag(). Until then s + c d = 0, c what a drag shears:
// shearing(). A wall is tissue that does not give way. Where a tool turns, its surface goes past what it
// touches as it rolls and spins, too: d acts, and s is measured, at the point of the sphere that touches.
//
// Of one sphere d follows from s; of several, equilibrium_grip.cpp has what holds them together.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"

namespace palpate::haptics {

using Eigen::Index;
using Eigen::Vector3d;

namespace {

// Of what the coupling gives way to a drag, what a wall does: enough that each of many spheres that it holds
// has its part in that, and none depends on the others.
constexpr double given_by_wall = 1e-3;

}  // namespace

// The vertices that bear a sphere, with their shares of the press; a wall has none.
void ContactEquilibrium::find_bearings(const Group& group, Bearings& bearings) const noexcept {
    bearings.clear();
    if (group.patch < 0) return;
    for (const Row& row : rows_of(group))
        for (std::size_t i = 0; i < 3 && row.force > 0; ++i) {
            const double share = row.weights[static_cast<Index>(i)] * row.force / hold_of(group).press;
            if (!(share > 0)) continue;
            const auto known = std::ranges::find(bearings, row.slots[i], &Bearing::slot);
            if (known != bearings.end())
                known->share += share;
            else
                bearings.push_back({row.slots[i], share});
        }
}

// How far a drag moves the sphere past the tissue that holds it, mm/N: about as far as a press lets it sink
// in (Mindlin 1949: by (1 - nu/2) / (1 - nu) as far, on a half-space). Past a wall hardly.
double ContactEquilibrium::shearing(const Group& group) const noexcept {
    const Hold& hold = hold_of(group);
    if (group.patch >= 0) return hold.axis.dot(touch_of(group).sinking * hold.axis);
    return given_by_wall * (1 / coupling_ + torsion_ * rubbing_arm(part_of(group), hold).squaredNorm());
}

// How far the point of a sphere that rubbed in the last tick has gone since, mm.
Vector3d ContactEquilibrium::way_past(const Group& group) const noexcept {
    const Tool& tool = tools_[static_cast<std::size_t>(group.tool)];
    const Part& part = part_of(group);
    const Hold& hold = hold_of(group);
    return part.sphere.device + off_of(tool, part) + tool.R_PT * hold.rubbed_arm - hold.rubbed_at;
}

// How far a sphere has gone past the tissue that bears it and was not held, mm; or past a wall.
Vector3d ContactEquilibrium::slip_of(const Group& group, const Bearings& bearings) const noexcept {
    const Hold& hold = hold_of(group);
    Vector3d slip = slip_before(group);
    if (hold.pressed) {
        slip += way_past(group);
        for (const auto& [slot, share] : bearings)
            slip -= share * (patch_of(group).displacement(slot) - patch_of(group).displacement_before(slot));
    }
    return slip - hold.axis.dot(slip) * hold.axis;
}

// What rubs, by what the rows press now.
void ContactEquilibrium::find_rubbing() noexcept {
    for (Tool& tool : tools_) each_hold(tool, [](Hold& hold) { hold.press = 0; });
    rubbing_.clear();
    tangents_.clear();
    const auto add = [&](const Group& group) {
        if (!measure_press(group)) return;
        Rubbing& rubbing = rubbing_.push_back();
        rubbing.group = &group;
        find_bearings(group, rubbing.bearings);
        rubbing.held = rubbing.let_go = false;
        rubbing.regrips = 0;
    };
    std::ranges::for_each(wall_groups_, add);
    std::ranges::for_each(groups_, add);
}

// What presses a sphere, and which way; false where nothing does.
bool ContactEquilibrium::measure_press(const Group& group) noexcept {
    Hold& hold = hold_of(group);
    hold.press = 0;
    Vector3d push = Vector3d::Zero();
    for (const Row& row : rows_of(group)) {
        hold.press += row.force;
        push += row.force * row.normal;
    }
    if (!(push.norm() > 0)) hold.press = 0;
    if (!(hold.press > 0)) return false;
    hold.axis = push.normalized();
    return true;
}

// The most that friction can be, N: Coulomb's, and by a profile that grips what the tissue bears over the
// area that is pressed (Bowden, Tabor 1950, The friction and lubrication of solids): a disc of Hertz's
// radius; of a sphere in a row, the part of it that is nearer to it than to the next ones.
double ContactEquilibrium::most_drag(const Group& group, double coefficient) const noexcept {
    const double press = hold_of(group).press;
    const LoadSpread* spread = group.patch < 0 ? nullptr : patch_of(group).body().spread();
    if (spread == nullptr || !(friction_.grip > 0)) return coefficient * press;
    const double sphere = part_of(group).radius,
                 slight = slight_press(sphere, *spread);  // below it, in proportion
    const double radius =
        std::min(sphere, std::cbrt(3 * std::max(press, slight) * sphere / (4 * spread->contact_modulus())));
    double area = std::numbers::pi * radius * radius;
    if (const Tool& tool = tools_[static_cast<std::size_t>(group.tool)]; tool.felt > 1)
        area =
            std::min(area, 2 * radius * (tool.parts[1].sphere.device - tool.parts[0].sphere.device).norm());
    return coefficient * press + friction_.grip * area * std::min(1.0, press / slight);
}

// What undoes the slip of one sphere as if it were alone.
void ContactEquilibrium::hold_alone(Rubbing& rubbing) noexcept {
    const Group& group = *rubbing.group;
    const Hold& hold = hold_of(group);
    const double shear = shearing(group);
    rubbing.drag = hold.drag - hold.axis.dot(hold.drag) * hold.axis;
    const Vector3d slip = slip_of(group, rubbing.bearings) + shear * rubbing.drag;
    const double way = slip.norm();
    if (!(way > 0)) return;
    const Vector3d along = slip / way;
    double compliance = 1 / coupling_ + shear;
    if (turns()) compliance += torsion_ * rubbing_arm(part_of(group), hold).cross(along).squaredNorm();
    for (const auto& [slot, share] : rubbing.bearings)
        for (const auto& [loaded, other] : rubbing.bearings)
            compliance += share * other * along.dot(patch_of(group).response(slot, loaded, along));
    rubbing.drag -= slip / compliance;
}

// Friction, for what the present forces press with.
void ContactEquilibrium::rub(std::size_t iterate) noexcept {
    for (DeformedPatch& patch : patches_) patch.begin_hold(iterate);
    for (Tool& tool : tools_) each_hold(tool, [&](Hold& hold) { hold.next_drag[iterate].setZero(); });
    for (Rubbing& rubbing : rubbing_) {
        const Group& group = *rubbing.group;
        Hold& hold = hold_of(group);
        if (!(hold.press > 0)) continue;
        if (rubbing.held)
            rubbing.drag -= hold.axis.dot(rubbing.drag) * hold.axis;
        else
            hold_alone(rubbing);
        const double wanted = rubbing.drag.norm();
        if (!rubbing.held || group.patch >= 0)
            hold.slides = wanted > most_drag(group, hold.slid ? friction_.sliding : friction_.at_rest);
        hold.slid = hold.slid || hold.slides;
        const double most = most_drag(group, friction_.sliding);
        if (hold.slides && wanted > most) rubbing.drag *= most / wanted;
        hold.next_drag[iterate] = rubbing.drag;
        for (const auto& [slot, share] : rubbing.bearings)
            patch_of(group).hold(iterate, slot, -share * rubbing.drag);
    }
    for (DeformedPatch& patch : patches_) patch.end_hold(iterate);
}

// Where tools and walls hold on to each other in the next tick; what does not press any more lets go.
void ContactEquilibrium::keep_hold_of_walls() noexcept {
    for (Tool& tool : tools_)
        each_hold(tool, [](Hold& hold) {
            if (hold.press > 0) return;
            hold.pressed = hold.slid = false;
            hold.slip.setZero();
        });
    for (const Rubbing& rubbing : rubbing_)
        if (rubbing.group->patch < 0) keep_hold(rubbing);
}

// The same of tools and tissue.
void ContactEquilibrium::keep_hold_of_tissue() noexcept {
    for (const Rubbing& rubbing : rubbing_)
        if (rubbing.group->patch >= 0 && tools_[static_cast<std::size_t>(rubbing.group->tool)].touching)
            keep_hold(rubbing);
}

void ContactEquilibrium::keep_hold(const Rubbing& rubbing) noexcept {
    const Group& group = *rubbing.group;
    Hold& hold = hold_of(group);
    if (!(hold.press > 0)) return;
    const double shear = shearing(group);
    hold.slip = hold.slides ? Vector3d(-shear * hold.drag) : slip_of(group, rubbing.bearings);
    hold.sheared = shear;
    hold.slid = hold.slides;
    hold.pressed = true;
    const Tool& tool = tools_[static_cast<std::size_t>(group.tool)];
    const Part& part = part_of(group);
    const Vector3d arm = rubbing_arm(part, hold) - part.swung;
    hold.rubbed_arm = tool.R_PT.transpose() * arm;
    hold.rubbed_at = part.sphere.device + off_of(tool, part) + arm;
}

}  // namespace palpate::haptics
