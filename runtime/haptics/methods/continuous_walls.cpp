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

using namespace collision;
using Eigen::Vector3d;

// mm of a plane that a tool that turns slips past: turning bends planes, and the next tick finds so little.
constexpr double slightly_beyond = 2e-3;
// Rounds in which walls are renewed; in later ones they are added to those there are, which comes to an end.
constexpr int renewing_rounds = 5;
constexpr double same_wall = 1e-4;             // mm, and
constexpr double same_wall_normal = 1 - 1e-6;  // cosine: walls that differ by less are one
constexpr double same_plane_normal = 1e-6;     // between unit normals, of which one is rounded to floats
constexpr double pressing_gap = 1e-5;          // mm from a wall that presses
constexpr double looked_behind = 0.02;         // mm behind walls that press it is looked for what is there
constexpr double beside = 0.2;                 // mm from a sphere within which what it met stays a wall
constexpr double touched = 0.02;               // mm from it, of what comes first
constexpr double least_press = 1e-4;           // N, likewise
constexpr double least_sum = 0.1;              // of unit normals: walls opposite each other have no side

}  // namespace

// Where each sphere is at the start of a tick: as far off its device as at the end of the one before.
void ContinuousContact::go_with_tool(Tool& tool) noexcept {
    for (Part& part : std::span(tool.parts).first(tool.parts_felt)) {
        if (part.goes_with_tool) {
            Vector3d to = part.device + tool.was_off;
            if (part.wall_press.norm() > least_press) to -= looked_behind * part.wall_press.normalized();
            part.with_tool.move(rigid_surfaces_, to);
        } else {
            part.with_tool.start_at(part.on_rigid);
            part.met.clear();
        }
        part.led_elsewhere = false;
        note_met(part);
    }
}

// Keeps the triangles that a sphere has met, as long as they are beside it; where there are too many, the
// nearest.
void ContinuousContact::note_met(Part& part) const noexcept {
    const GodObject& sphere = part.with_tool;
    const auto distance = [&](const MetTriangle& met) {
        const CollisionSurface& surface = *rigid_surfaces_[met.surface];
        return std::sqrt(
            closest_point_on_triangle(sphere.position(), surface.corners(met.slot)).squared_distance);
    };
    for (MetTriangle& met : part.met) met.distance = distance(met);
    part.met.erase_if([&](const MetTriangle& met) { return met.distance > sphere.radius() + beside; });
    for (const GodObject::Touch& touch : sphere.touches()) {
        const auto is_it = [&](const MetTriangle& met) {
            return met.surface == touch.surface && met.slot == touch.foot.slot;
        };
        if (std::ranges::any_of(part.met, is_it)) continue;
        const MetTriangle met{touch.surface, touch.foot.slot, touch.foot.distance};
        if (!part.met.full()) {
            part.met.push_back(met);
            continue;
        }
        MetTriangle& farthest = *std::ranges::max_element(part.met, {}, &MetTriangle::distance);
        if (farthest.distance > met.distance) farthest = met;
    }
}

// What it touches, or might, of these.
ContinuousContact::Walls ContinuousContact::walls_of(const Part& part) const noexcept {
    Walls walls;
    const Vector3d& centre = part.with_tool.position();
    for (const MetTriangle& met : part.met) {
        const CollisionSurface& surface = *rigid_surfaces_[met.surface];
        const TrianglePoint foot = closest_point_on_triangle(centre, surface.corners(met.slot));
        const double distance = std::sqrt(foot.squared_distance);
        // Triangles have edges and corners in common.
        const auto is_same = [&](const GodObject::Touch& wall) {
            return (wall.foot.point - foot.point).squaredNorm() < same_place * same_place;
        };
        if (!(distance > 0) || std::ranges::any_of(walls, is_same)) continue;
        walls.push_back({{foot.point, foot.barycentric, distance, surface.mesh_triangle(met.slot), met.slot,
                          foot.feature},
                         (centre - foot.point) / distance,
                         met.surface});
    }
    return walls;
}

// The walls that a tool has at the start of a tick, or instead of or besides others.
void ContinuousContact::add_walls(std::size_t t, TickResult& result) noexcept {
    Tool& tool = tools_[t];
    const auto parts = std::span(tool.parts).first(tool.parts_felt);
    tool.lacks_walls = false;
    if (!goes_along_) {
        // What finds no room here and is missed in the solution is found as what that meets.
        for (std::size_t p = 0; p < parts.size(); ++p) {
            const GodObject& sphere = parts[p].on_rigid;
            const Vector3d lifted = sphere.position() + sphere.held_back() - parts[p].device;
            for (const GodObject::Touch& touch : sphere.touches())
                if (!hold_by(t, p, rigid_contact(touch, touch.normal, touch.normal.dot(lifted)), result))
                    return;
        }
        return;
    }
    // What a sphere is beside comes last, and only where what it touches led elsewhere.
    for (const bool touching : {true, false})
        for (std::size_t p = 0; p < parts.size(); ++p) {
            if (!touching && !parts[p].led_elsewhere) continue;
            for (const GodObject::Touch& wall : walls_of(parts[p])) {
                if ((wall.foot.distance < parts[p].with_tool.radius() + touched) != touching) continue;
                const double gap = gap_at(wall, parts[p]);
                // One behind a parallel one holds nothing; in later rounds it is there already.
                const auto does_as_well = [&](const Contact& other) {
                    return (normal_of(other) - wall.normal)
                               .norm()<same_plane_normal&& static_cast<double>(other.gap)>
                                   gap -
                           pressing_gap;
                };
                if (std::ranges::any_of(result.active_contacts(), does_as_well) ||
                    hold_by(t, p, rigid_contact(wall, wall.normal, gap), result))
                    continue;
                tool.lacks_walls = touching;
                return;
            }
        }
}

// How far a sphere's device is beyond the plane of a wall.
double ContinuousContact::gap_at(const GodObject::Touch& wall, const Part& part) noexcept {
    return wall.normal.dot(wall.foot.point - part.device) + part.with_tool.radius() + GodObject::skin;
}

// Tells whether the solution has a tool where walls other than those that it was solved for hold it.
bool ContinuousContact::find_other_walls(std::span<TickResult> results, int round) noexcept {
    if (!goes_along_) return meets_others_on_the_way();
    bool any = false;
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        Tool& tool = tools_[t];
        tool.led_elsewhere = (equilibrium_.touches_tissue(t) || is_held(tool)) &&
                             leads_elsewhere(tool, off_of(t), results[t], round < renewing_rounds);
        any = any || tool.led_elsewhere;
    }
    return any;
}

// Has those hold it.
void ContinuousContact::hold_by_other_walls(std::span<TickResult> results, int round) noexcept {
    if (!goes_along_) return hold_by_met(results);
    if (round >= renewing_rounds && equilibrium_.walls_are_full()) drop_idle_walls(results);
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        if (!tools_[t].led_elsewhere) continue;
        if (round < renewing_rounds) {
            equilibrium_.drop_walls(t);
            results[t].contact_count = 0;
        }
        add_walls(t, results[t]);
    }
}

// Lets each sphere go on to where a solution has it, `off` (mm) its device. Tells whether other walls than
// those that hold it do so there; or, where they are not renewed, besides those.
bool ContinuousContact::leads_elsewhere(Tool& tool, const Vector3d& off, const TickResult& result,
                                        bool renews) noexcept {
    bool any = false;
    for (std::size_t p = 0; p < tool.parts_felt; ++p) {
        Part& part = tool.parts[p];
        const auto presses = [&](const Contact& wall) {
            return is_wall(wall) && wall.part == static_cast<std::int32_t>(p) &&
                   normal_of(wall).dot(off) - static_cast<double>(wall.gap) < pressing_gap;
        };
        Vector3d behind = Vector3d::Zero();
        for (const Contact& wall : result.active_contacts())
            if (presses(wall)) behind -= normal_of(wall);
        behind = behind.norm() > least_sum ? Vector3d(looked_behind * behind.normalized()) : Vector3d::Zero();
        part.with_tool.move(rigid_surfaces_, part.device + off + behind);
        note_met(part);
        const Walls walls = walls_of(part);
        const auto beyond = [&](const GodObject::Touch& wall) {
            return gap_at(wall, part) - wall.normal.dot(off);
        };
        const auto is_among_walls = [&](const Contact& held) {
            return std::ranges::any_of(walls, [&](const GodObject::Touch& wall) {
                return wall.normal.dot(normal_of(held)) > same_wall_normal &&
                       std::abs(beyond(wall)) < same_wall;
            });
        };
        const bool elsewhere =
            std::ranges::any_of(walls, [&](const auto& wall) { return beyond(wall) > same_wall; }) ||
            (renews && std::ranges::any_of(result.active_contacts(), [&](const Contact& wall) {
                 return presses(wall) && !is_among_walls(wall);
             }));
        part.led_elsewhere = part.led_elsewhere || elsewhere;
        any = any || elsewhere;
    }
    return any;
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
