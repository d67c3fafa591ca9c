// SPDX-License-Identifier: Apache-2.0
// Which walls hold a tool that more than its tip's rest on rigid bodies holds; part of the continuous
// contact's tick.
//
// Walls are half-spaces, and tool and tissue come to rest among them: so they have to be those that the tool
// meets where it comes to rest, not where its device has it. With a lone sphere another goes along, as far as
// rigid bodies let it; its touches are the walls, and are renewed until the solution leads nowhere else. What
// was met on the way counts only where that has not ended after some rounds: half-spaces of a bent surface
// would keep the tool from where it gets to round the edge. Tools of several spheres are held by what these
// meet on the way.
#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/haptics/methods/continuous_contact.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

// mm of a plane that a tool that turns slips past: turning bends planes, and the next tick finds so little.
constexpr double slightly_beyond = 2e-3;
// Rounds in which walls are renewed; in later ones they are added to those there are, which comes to an end.
constexpr int renewing_rounds = 5;
constexpr double same_wall = 1e-4;      // mm, which move a force by 0.05 mN behind the usual coupling
constexpr double same_normal = 1e-6;    // between unit normals, of which one is rounded to floats
constexpr double turned_normal = 1e-3;  // likewise: turned by more it is another wall
constexpr double pressing = 1e-5;       // mm from a wall that presses
// mm behind walls that press, where it is looked for what is there: as much as a sphere that slid hovers.
constexpr double looked_behind = 0.02;
constexpr double least_sum = 0.1;  // of unit normals: walls opposite each other have no side

bool presses(const Contact& wall, const Vector3d& off) noexcept {
    return normal_of(wall).dot(off) - static_cast<double>(wall.gap) < pressing;
}

}  // namespace

// The walls that hold a tool at the start of a tick: of a lone sphere those where it is, if it is as far off
// its device as at the end of the one before.
void ContinuousContact::begin_walls(std::size_t t, TickResult& result) noexcept {
    Tool& tool = tools_[t];
    if (goes_along()) {
        Along& along = along_[t];
        if (along.goes_on)
            along.follower.go(rigid_surfaces_, tool.parts[0].device + along.to);
        else
            along.follower.start_at(tool.parts[0].on_rigid);
        along.led_elsewhere = false;
        return add_walls_along(t, result);
    }
    // What finds no room here and is missed in the solution is found as what that meets.
    for (std::size_t p = 0; p < tool.parts_felt; ++p) {
        const GodObject& sphere = tool.parts[p].on_rigid;
        const Vector3d lifted = sphere.position() + sphere.held_back() - tool.parts[p].device;
        for (const GodObject::Touch& touch : sphere.touches())
            if (!hold_by(t, p, rigid_contact(touch, touch.normal, touch.normal.dot(lifted)), result)) return;
    }
}

// What a lone sphere touches, and what it is beside if that led elsewhere; of parallel walls the nearest.
void ContinuousContact::add_walls_along(std::size_t t, TickResult& result) noexcept {
    const Along& along = along_[t];
    for (const GodObject::Touch& wall : along.follower.walls()) {
        if (!along.led_elsewhere && !along.follower.touches(wall)) continue;
        const double gap = along.follower.beyond(wall, tools_[t].parts[0].device);
        const auto does_as_well = [&](const Contact& other) {
            const double farther = gap - static_cast<double>(other.gap);
            return farther < pressing && (normal_of(other) - wall.normal).norm() < same_normal;
        };
        if (std::ranges::any_of(result.active_contacts(), does_as_well)) continue;
        if (!hold_by(t, 0, rigid_contact(wall, wall.normal, gap), result)) result.status |= contacts_cut;
    }
}

// Tells whether the solution has a tool where walls other than those that it was solved for hold it.
bool ContinuousContact::find_other_walls(std::span<TickResult> results, int round) noexcept {
    if (!goes_along()) return meets_others_on_the_way();
    bool any = false;
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        along_[t].led_elsewhere =
            equilibrium_.touches_tissue(t) && leads_elsewhere(t, results[t], round < renewing_rounds);
        any = any || along_[t].led_elsewhere;
    }
    return any;
}

// Has those hold it.
void ContinuousContact::hold_by_other_walls(std::span<TickResult> results, int round) noexcept {
    if (!goes_along()) return hold_by_met(results);
    const bool renews = round < renewing_rounds;
    if (!renews && equilibrium_.walls_are_full()) drop_idle_walls(results);
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        if (!along_[t].led_elsewhere) continue;
        if (renews) {
            equilibrium_.drop_walls(t);
            results[t].contact_count = 0;
        }
        add_walls_along(t, results[t]);
    }
}

// Where the solution has a lone sphere off its device, and a little behind the walls that press it there, mm.
Vector3d ContinuousContact::behind_walls(std::size_t t, const TickResult& result) const noexcept {
    const Vector3d off = off_of(t);
    Vector3d sum = Vector3d::Zero();
    for (const Contact& contact : result.active_contacts())
        if (is_wall(contact) && presses(contact, off)) sum += normal_of(contact);
    return sum.norm() > least_sum ? Vector3d(off - looked_behind * sum.normalized()) : off;
}

// Lets the sphere that goes along go on to where a solution has the tool. Tells whether other walls than
// those that hold it do so there; or, where they are not renewed, besides those.
bool ContinuousContact::leads_elsewhere(std::size_t t, const TickResult& result, bool renews) noexcept {
    WallFollower& follower = along_[t].follower;
    const Vector3d &device = tools_[t].parts[0].device, off = off_of(t);
    follower.go(rigid_surfaces_, device + behind_walls(t, result));
    const auto beyond = [&](const GodObject::Touch& wall) { return follower.beyond(wall, device + off); };
    const auto is_gone = [&](const Contact& held) {
        return presses(held, off) && std::ranges::none_of(follower.walls(), [&](const auto& wall) {
                   return (wall.normal - normal_of(held)).norm() < turned_normal &&
                          std::abs(beyond(wall)) < same_wall;
               });
    };
    return std::ranges::any_of(follower.walls(),
                               [&](const auto& wall) { return beyond(wall) > same_wall; }) ||
           (renews && std::ranges::any_of(result.active_contacts(), is_gone));
}

// A lone sphere is on its way then, as where it slips off a ridge of bone, and goes on in the next tick; what
// holds several contradicts itself.
void ContinuousContact::say_led_elsewhere(std::span<TickResult> results) const noexcept {
    for (std::size_t t = 0; t < tools_.size(); ++t)
        if (!goes_along())
            results[t].status |= contact_unsolved;
        else if (along_[t].led_elsewhere)
            results[t].status |= contact_unsettled;
}

// A lone sphere that tissue pushes goes on from where it is now. What walls' friction does to it is left out:
// that is asked for once they are known.
void ContinuousContact::keep_along(std::size_t t, const TickResult& result) noexcept {
    along_[t].goes_on = equilibrium_.touches_tissue(t);
    if (along_[t].goes_on) along_[t].to = behind_walls(t, result);
}

// Of tools of several spheres: what they would meet between where rigid bodies let them rest and where
// the solution has them, what they would go through farthest first.
bool ContinuousContact::meets_others_on_the_way() noexcept {
    met_.clear();
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        if (!equilibrium_.touches_tissue(t) && !is_held(tools_[t])) continue;
        for (std::size_t p = 0; p < tools_[t].parts_felt; ++p) {
            Part& part = tools_[t].parts[p];
            const Vector3d push = off_of(t) + equilibrium_.turned_off(t, p);
            const auto touch = part.on_rigid.touch_on_the_way(
                rigid_surfaces_, part.device + push, torsion_ > 0 ? slightly_beyond : GodObject::nothing);
            if (!touch) continue;
            const double gap = touch->normal.dot(touch->foot.point - part.device) + part.on_rigid.radius();
            const double beyond = gap - touch->normal.dot(push);
            if (met_.full() && beyond <= met_[met_.size() - 1].beyond) continue;
            if (met_.full()) met_.cut(met_.size() - 1);
            met_.push_back({t, p, *touch, gap, beyond});
            for (std::size_t k = met_.size() - 1; k > 0 && met_[k - 1].beyond < beyond; --k)
                std::swap(met_[k - 1], met_[k]);
        }
    }
    return !met_.empty();
}

void ContinuousContact::hold_by_met(std::span<TickResult> results) noexcept {
    if (equilibrium_.walls_are_full()) drop_idle_walls(results);
    const bool all_press = equilibrium_.walls_are_full();
    for (const MetWall& met : met_) {
        TickResult& result = results[met.tool];
        if (all_press) result.status |= contacts_cut;
        hold_by(met.tool, met.part, rigid_contact(met.touch, met.touch.normal, met.gap), result);
    }
}

// Adds a wall that holds part `p` of a tool; false where there is no more room.
bool ContinuousContact::hold_by(std::size_t t, std::size_t p, const Contact& wall,
                                TickResult& result) noexcept {
    if (equilibrium_.walls_are_full()) return false;
    Contact& contact = result.contacts[static_cast<std::size_t>(result.contact_count++)];
    contact = wall;
    contact.part = static_cast<std::int32_t>(p);
    equilibrium_.add_wall(t, contact);
    return true;
}

// Makes room for walls that press: the answer is the same without those that do not.
void ContinuousContact::drop_idle_walls(std::span<TickResult> results) noexcept {
    for (std::size_t t = 0; t < tools_.size(); ++t)
        results[t].contact_count =
            static_cast<std::int32_t>(equilibrium_.drop_idle_walls(t, results[t].contacts));
}

}  // namespace palpate::haptics
