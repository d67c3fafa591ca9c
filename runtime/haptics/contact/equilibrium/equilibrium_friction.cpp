// SPDX-License-Identifier: Apache-2.0
// Friction between tools and tissue; part of the tick.
//
// Where a sphere presses, friction holds it and the tissue together: the drag d on the tool is what undoes
// the way s that they have gone past each other, along with the coupling and the tissue's own compliance,
// until that is more than there can be: most_drag(). Until then s + c d = 0, c what a drag shears:
// shearing().
//
// Of one sphere d follows from s. Of several, d and what presses are unknown together:
//     w = A f - gaps >= 0, f >= 0, f . w = 0    for what presses, as without friction,
//     s + c d = 0                               for two directions d of each sphere that does not slide,
// with s and gaps linear in f and d by one symmetric matrix: a ContactLcp some of whose rows may pull.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"

namespace palpate::haptics {

using Eigen::Index;
using Eigen::Vector3d;

// The vertices that bear a sphere, with their shares of the press.
void ContactEquilibrium::find_bearings(const Group& group, Bearings& bearings) const noexcept {
    bearings.clear();
    for (const Row& row : rows_of(group))
        for (std::size_t i = 0; i < 3 && row.force > 0; ++i) {
            const double share = row.weights[static_cast<Index>(i)] * row.force / touch_of(group).press;
            if (!(share > 0)) continue;
            const auto known = std::ranges::find(bearings, row.slots[i], &Bearing::slot);
            if (known != bearings.end())
                known->share += share;
            else
                bearings.push_back({row.slots[i], share});
        }
}

// How far a sphere has gone past the tissue that bears it and was not held, mm.
Vector3d ContactEquilibrium::slip_of(const Group& group, const Bearings& bearings) const noexcept {
    const Touch& touch = touch_of(group);
    Vector3d slip = slip_before(touch);
    if (touch.pressed) {
        const Tool& tool = tools_[static_cast<std::size_t>(group.tool)];
        const Part& part = part_of(group);
        slip += part.sphere.device + off_of(tool, part) - touch.rubbed_centre;
        const DeformedPatch& patch = patch_of(group);
        for (const auto& [slot, share] : bearings)
            slip -= share * (patch.displacement(slot) - patch.displacement_before(slot));
    }
    return slip - touch.axis.dot(slip) * touch.axis;
}

// The same if nothing pressed, with friction as it is.
Vector3d ContactEquilibrium::free_slip_of(const Rubbing& rubbing) const noexcept {
    const Touch& touch = touch_of(*rubbing.group);
    const Part& part = part_of(*rubbing.group);
    const Tool& tool = tools_[static_cast<std::size_t>(rubbing.group->tool)];
    Vector3d slip =
        slip_before(touch) + part.sphere.device + dragged_off_of(tool, part) - touch.rubbed_centre;
    // What turning moves the sphere beyond what is in proportion to what turns it.
    if (turns()) slip += off_of(tool, part) - tool.off - tool.turn.cross(part.swung);
    const DeformedPatch& patch = patch_of(*rubbing.group);
    for (const auto& [slot, share] : rubbing.bearings)
        slip -= share * (patch.held_displacement(slot) - patch.displacement_before(slot));
    return slip;
}

// What rubs, by what the rows press now.
void ContactEquilibrium::find_rubbing() noexcept {
    for (Tool& tool : tools_)
        for (Part& part : tool.parts)
            for (Touch& touch : part.touches) touch.press = 0;
    rubbing_.clear();
    tangents_.clear();
    for (const Group& group : groups_) {
        if (!measure_press(group)) continue;
        Rubbing& rubbing = rubbing_.push_back();
        rubbing.group = &group;
        find_bearings(group, rubbing.bearings);
        rubbing.held = false;
    }
}

// What presses a sphere, and which way; false where nothing does.
bool ContactEquilibrium::measure_press(const Group& group) noexcept {
    Touch& touch = touch_of(group);
    touch.press = 0;
    Vector3d push = Vector3d::Zero();
    for (const Row& row : rows_of(group)) {
        touch.press += row.force;
        push += row.force * row.normal;
    }
    if (!(touch.press > 0) || !(push.norm() > 0)) return false;
    touch.axis = push.normalized();
    return true;
}

// Where several spheres hold the same tissue or hang on the same tool, what presses them and what holds them
// is one problem: solves it again, each sphere that does not slide with two rows that hold it along the
// surface.
void ContactEquilibrium::hold_together() noexcept {
    for (Rubbing& rubbing : rubbing_) {
        const Touch& touch = touch_of(*rubbing.group);
        if (!touch.pressed || touch.slides || tangents_.size() + 2 > ContactLcp::most_tangents) continue;
        rubbing.held = true;
        rubbing.drag = touch.drag;
        const Vector3d along = touch.axis.unitOrthogonal();
        tangents_.push_back({&rubbing, along});
        tangents_.push_back({&rubbing, touch.axis.cross(along)});
    }
    if (tangents_.empty()) return;
    const std::size_t first = rows_.size() + neighbours_.row_count();
    for (std::size_t t = 0; t < tangents_.size(); ++t) {
        fill_tangent(t);
        const Rubbing& rubbing = *tangents_[t].rubbing;
        const auto row = static_cast<Index>(first + t);
        const double shear = shearing(touch_of(*rubbing.group));
        lcp_.matrix()(row, row) += shear;
        lcp_.gaps()[row] = -tangents_[t].along.dot(free_slip_of(rubbing) + shear * rubbing.drag);
    }
    residual_ = lcp_.solve_with(first, tangents_.size(), [&](std::size_t row) { fill_any_column(row); });
    for (std::size_t t = 0; t < tangents_.size(); ++t)
        tangents_[t].rubbing->drag += lcp_.forces()[static_cast<Index>(first + t)] * tangents_[t].along;
    take_forces();
    for (Rubbing& rubbing : rubbing_)
        if (measure_press(*rubbing.group)) find_bearings(*rubbing.group, rubbing.bearings);
}

// How far a drag along one tangent, and its opposite on the tissue, opens the rows and moves spheres past
// their tissue.
void ContactEquilibrium::fill_tangent(std::size_t t) noexcept {
    const Tangent& dragged = tangents_[t];
    const Group& group = *dragged.rubbing->group;
    patch_of(group).yield(dragged.rubbing->bearings, dragged.along, field_);
    const Vector3d lever = part_of(group).swung.cross(dragged.along);
    const auto way_of = [&](const auto& other, const Vector3d& along) {
        if (other.tool != group.tool) return 0.0;
        const double turning = turns() ? torsion_ * lever.dot(part_of(other).swung.cross(along)) : 0;
        return along.dot(dragged.along) / coupling_ + turning;
    };
    const auto column = static_cast<Index>(rows_.size() + neighbours_.row_count() + t);
    Index at = 0;
    const auto write = [&](double value) {
        lcp_.matrix()(at, column) = lcp_.matrix()(column, at) = value;
        ++at;
    };
    for (const Row& row : rows_) {
        double opens = way_of(row, row.normal);
        if (row.patch == group.patch)
            opens += row.normal.dot(DeformedPatch::mean(field_, row.slots, row.weights));
        write(opens);
    }
    for (std::size_t k = 0; k < neighbours_.row_count(); ++k)
        write(neighbours_.closing(k, group.patch, field_));
    for (const Tangent& tangent : tangents_) {
        const Group& other = *tangent.rubbing->group;
        double slips = way_of(other, tangent.along);
        if (other.patch == group.patch)
            for (const auto& [slot, share] : tangent.rubbing->bearings) {
                const Vector3d moved = field_[static_cast<std::size_t>(slot)].head<3>().cast<double>();
                slips += share * tangent.along.dot(moved);
            }
        write(slips);
    }
}

// The most that friction can be, N: Coulomb's, and by a profile that grips what the tissue bears over the
// area that is pressed (Bowden, Tabor 1950, The friction and lubrication of solids): a disc of Hertz's
// radius; of a sphere in a row, the part of it that is nearer to it than to the next ones.
double ContactEquilibrium::most_drag(const Group& group, double coefficient) const noexcept {
    const double press = touch_of(group).press;
    const LoadSpread* spread = patch_of(group).body().spread();
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
    const Touch& touch = touch_of(*rubbing.group);
    rubbing.drag = touch.drag - touch.axis.dot(touch.drag) * touch.axis;
    const Vector3d slip = slip_of(*rubbing.group, rubbing.bearings) + shearing(touch) * rubbing.drag;
    const double way = slip.norm();
    if (!(way > 0)) return;
    const Vector3d along = slip / way;
    const DeformedPatch& patch = patch_of(*rubbing.group);
    double compliance = 1 / coupling_ + shearing(touch);
    if (turns()) compliance += torsion_ * part_of(*rubbing.group).swung.cross(along).squaredNorm();
    for (const auto& [slot, share] : rubbing.bearings)
        for (const auto& [loaded, other] : rubbing.bearings)
            compliance += share * other * along.dot(patch.response(slot, loaded, along));
    rubbing.drag -= slip / compliance;
}

// Friction, for what the present forces press with.
void ContactEquilibrium::rub(std::size_t iterate) noexcept {
    for (DeformedPatch& patch : patches_) patch.begin_hold(iterate);
    for (Tool& tool : tools_)
        for (Part& part : tool.parts)
            for (Touch& touch : part.touches) touch.next_drag[iterate].setZero();
    for (Rubbing& rubbing : rubbing_) {
        Touch& touch = touch_of(*rubbing.group);
        if (!(touch.press > 0)) continue;
        if (rubbing.held)
            rubbing.drag -= touch.axis.dot(rubbing.drag) * touch.axis;
        else
            hold_alone(rubbing);
        DeformedPatch& patch = patch_of(*rubbing.group);
        const double wanted = rubbing.drag.norm();
        touch.slides = wanted > most_drag(*rubbing.group, touch.slid ? friction_.sliding : friction_.at_rest);
        touch.slid = touch.slid || touch.slides;
        if (touch.slides) rubbing.drag *= most_drag(*rubbing.group, friction_.sliding) / wanted;
        touch.next_drag[iterate] = rubbing.drag;
        for (const auto& [slot, share] : rubbing.bearings) patch.hold(iterate, slot, -share * rubbing.drag);
    }
    for (DeformedPatch& patch : patches_) patch.end_hold(iterate);
}

// Where tools and tissue hold on to each other in the next tick.
void ContactEquilibrium::keep_hold() noexcept {
    for (Tool& tool : tools_)
        for (Part& part : tool.parts)
            for (Touch& touch : part.touches) {
                if (touch.press > 0) continue;
                touch.pressed = touch.slid = false;
                touch.slip.setZero();
            }
    for (const Rubbing& rubbing : rubbing_) {
        const Group& group = *rubbing.group;
        const Tool& tool = tools_[static_cast<std::size_t>(group.tool)];
        Touch& touch = touch_of(group);
        if (!(touch.press > 0) || !tool.touching) continue;
        touch.slip =
            touch.slides ? Vector3d(-shearing(touch) * touch.drag) : slip_of(group, rubbing.bearings);
        touch.sheared = shearing(touch);
        touch.slid = touch.slides;
        touch.pressed = true;
        const Part& part = part_of(group);
        touch.rubbed_centre = part.sphere.device + off_of(tool, part);
    }
}

}  // namespace palpate::haptics
