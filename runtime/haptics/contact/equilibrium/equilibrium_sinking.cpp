// SPDX-License-Identifier: Apache-2.0
// How far spheres sink into tissue, beyond what its surface gives way; part of the tick.
//
// s follows the press F = sum p f n on what gives way. Where p changes along the surface, s changes F in
// turn: it tilts the surface under the sphere, whose contact moves by r |grad p| ds, to where less gives way.
// So
//     dF/ds = -R,    R = sum f r |grad p|²,
// which is large beside what a small press takes to sink in deeper. s is linearised with that, about where it
// is: steps are then as long as they should be. Where it leads to is not changed: s = s(F) there.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "formats/model/contact/local_indentation.hpp"
#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"

namespace palpate::haptics {

using namespace collision;
using Eigen::Index;
using Eigen::Vector3d;

// How much of a row's point gives way, and how that changes along the face or edge that the point lies on.
void ContactEquilibrium::find_part_giving_way(Row& row, const DeformedPatch& patch,
                                              const TriangleCorners& met) noexcept {
    std::array<bool, 3> gives{};
    for (std::size_t i = 0; i < 3; ++i) gives[i] = patch.gives_way(row.slots[i]);
    if (gives[0] && gives[1] && gives[2]) return;
    row.part_giving_way = 0;
    for (std::size_t i = 0; i < 3; ++i)
        if (gives[i]) row.part_giving_way += row.weights[static_cast<Index>(i)];
    if (!(row.part_giving_way > 0)) return;
    // One corner differs from the others.
    const std::size_t odd = gives[1] == gives[2] ? 0 : gives[0] == gives[2] ? 1 : 2;
    const std::size_t next = (odd + 1) % 3, last = (odd + 2) % 3;
    const Vector3d to_next = met[next] - met[odd], to_last = met[last] - met[odd];
    const auto on = [&](std::size_t corner) { return row.weights[static_cast<Index>(corner)] > 0; };
    if (!on(odd) || !(on(next) || on(last))) return;  // at a vertex, or along the edge across: not at all
    if (!on(last))
        row.slope_squared = 1 / to_next.squaredNorm();
    else if (!on(next))
        row.slope_squared = 1 / to_last.squaredNorm();
    else
        row.slope_squared = (to_last - to_next).squaredNorm() / to_next.cross(to_last).squaredNorm();
}

// How a sphere sinks in, about the press that was found last; before any, about a slight one.
void ContactEquilibrium::linearise(double radius, Touch& touch, const DeformedPatch& patch) noexcept {
    touch.sunk_free.setZero();
    touch.sinking.setZero();
    const LoadSpread* spread = patch.body().spread();
    if (!spread) return;
    const double now = touch.creep != nullptr ? touch.creep->now : 1;
    const Vector3d push = pushed_by(touch);
    const double known = push.norm(), press = std::max(known, slight_press(radius, *spread));
    const LocalIndentation local =
        local_indentation(press, radius, spread->contact_modulus(), spread->radius());
    if (!(press > 0)) return;
    const double across = local.depth / press, righting = now * touch.righting;
    if (known >= press) {
        const Vector3d axis = push / known;
        const double turned = righting * local.slope, slope = local.slope / (1 + turned);
        const double depth = (local.depth + turned * axis.dot(touch.sunk)) / (1 + turned);
        touch.sinking = across * Eigen::Matrix3d::Identity() + (slope - across) * axis * axis.transpose();
        touch.sunk_free = (depth - slope * press) * axis;
    } else {
        const double turned = righting * across;
        touch.sinking = across / (1 + turned) * Eigen::Matrix3d::Identity();
        touch.sunk_free = turned / (1 + turned) * touch.sunk;
    }
    if (touch.creep == nullptr) return;
    touch.sunk_free += touch.sinking * touch.lasting_push;
    touch.sinking *= now;
}

Vector3d ContactEquilibrium::local_dent(double radius, const Touch& touch,
                                        const DeformedPatch& patch) noexcept {
    const double push = touch.lasting_push.norm();
    if (touch.creep == nullptr || !(push > 0)) return Vector3d::Zero();
    const LoadSpread& spread = *patch.body().spread();
    return local_indentation(push, radius, spread.contact_modulus(), spread.radius()).depth / push *
           touch.lasting_push;
}

// How far the present forces sink each sphere into each body; returns by how much that is off what they
// should, mm.
double ContactEquilibrium::sink(std::size_t iterate) noexcept {
    double change = 0;
    for (Tool& tool : tools_)
        for (Part& part : std::span(tool.parts).first(tool.felt))
            for (std::size_t soft = 0; soft < patches_.size(); ++soft) {
                Touch& touch = part.touches[soft];
                touch.push.setZero();
                touch.righting = 0;
                touch.next_sunk[iterate] = local_dent(part.radius, touch, patches_[soft]);
            }
    for (const Group& group : groups_) {
        Touch& touch = touch_of(group);
        const double radius = part_of(group).radius;
        const LoadSpread* spread = patch_of(group).body().spread();
        if (!spread) continue;
        for (const Row& row : rows_of(group)) {
            touch.push += row.part_giving_way * row.force * row.normal;
            touch.righting += row.force * row.radius * row.slope_squared;
        }
        if (touch.push.isZero(0)) continue;
        touch.next_sunk[iterate] = touch.sunk_free + touch.sinking * touch.push;
        const Vector3d push = pushed_by(touch);
        if (push.isZero(0)) continue;
        const double along = std::max(push.norm(), slight_press(radius, *spread));
        const LocalIndentation local =
            local_indentation(along, radius, spread->contact_modulus(), spread->radius());
        const Vector3d wanted = local.depth / along * push;
        change = std::max(change, (wanted - touch.next_sunk[iterate]).lpNorm<Eigen::Infinity>());
    }
    if (are_one_surface_) share_sinking(iterate);
    return change;
}

// Adds how far what presses some of a tool's spheres sinks in the others.
void ContactEquilibrium::share_sinking(std::size_t iterate) noexcept {
    for (Tool& tool : tools_)
        for (Part& part : tool.parts)
            for (Touch& touch : part.touches) touch.shared.setZero();
    for (const Group& group : groups_) {
        const auto soft = static_cast<std::size_t>(group.patch);
        const Vector3d push = pushed_by(touch_of(group));
        if (beside_[soft].size() == 0 || push.isZero(0)) continue;
        Tool& tool = tools_[static_cast<std::size_t>(group.tool)];
        for (std::size_t p = 0; p < tool.felt; ++p)
            tool.parts[p].touches[soft].shared += beside_[soft](static_cast<Index>(p), group.part) * push;
    }
    for (Tool& tool : tools_)
        for (Part& part : std::span(tool.parts).first(tool.felt))
            for (Touch& touch : part.touches) {
                touch.next_sunk[iterate] += touch.shared;
                // What is far from all triangles is no part of the search.
                if (touch.is_far()) touch.sunk = touch.next_sunk[iterate];
            }
}

// What a sphere sinks in locally creeps too: s follows now F and what is left of earlier presses, as a sphere
// on a half-space that creeps does while its contact grows (Lee, Radok 1960). That is kept with the sphere,
// as the tissue under it when it began to press creeps, until it is clear of the body.
void ContactEquilibrium::remember_pushes() noexcept {
    for (const Group& group : groups_) {
        Touch& touch = touch_of(group);
        const DeformableContact& body = patch_of(group).body();
        if (touch.creep != nullptr || !body.creeps() || body.spread() == nullptr) continue;
        // The vertex that gives way and bears most.
        double most = 0;
        for (const Row& row : rows_of(group))
            for (std::size_t i = 0; i < 3; ++i) {
                const std::int32_t vertex = body.triangle(row.triangle)[i];
                const double borne = row.force * row.weights[static_cast<Index>(i)];
                if (borne <= most || !body.gives_way(vertex)) continue;
                most = borne;
                touch.creep = body.creep_of(vertex);
            }
    }
    for (Tool& tool : tools_)
        for (Part& part : tool.parts)
            for (Touch& touch : part.touches) {
                if (touch.creep == nullptr) continue;
                touch.left_push.take(*touch.creep, touch.push);
                touch.lasting_push = touch.left_push.lasting(*touch.creep);
            }
}

}  // namespace palpate::haptics
