// SPDX-License-Identifier: Apache-2.0
// Which triangles may press a tool in a tick, and their complementarity problem; part of the tick.
#include <Eigen/Geometry>
#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"

namespace palpate::haptics {
namespace {

using namespace collision;
using Eigen::Index;
using Eigen::Vector3d;

constexpr double look_margin = 1;  // mm: how much farther around is looked
// Rounds for which a triangle is passed over. The patch knows its vertices for longer.
constexpr std::int32_t most_rounds = 16;

}  // namespace

// The feet on which a sphere rests if nothing gives way, with the surface at rest: where contact starts.
void ContactEquilibrium::gather_at_rest(std::size_t t, std::size_t p) noexcept {
    Part& part = tools_[t].parts[p];
    for (std::size_t soft = 0; soft < patches_.size(); ++soft)
        linearise(part.radius, part.touches[soft], patches_[soft]);
    for (const GodObject::Touch& touch : part.sphere.if_rigid->touches()) {
        if (touch.surface < bodies_.rigid_count()) continue;
        const std::size_t soft = touch.surface - bodies_.rigid_count();
        DeformedPatch& patch = patches_[soft];
        Row row;
        if (!patch.slots_of(touch.foot.triangle, row.slots)) continue;
        row.tool = static_cast<std::int32_t>(t);
        row.part = static_cast<std::int32_t>(p);
        row.patch = static_cast<std::int32_t>(soft);
        row.triangle = touch.foot.triangle;
        row.weights = touch.foot.barycentric;
        row.normal = touch.normal;
        const RoundedTriangle round = patch.rounded(row.triangle, patch.corners(row.slots));
        row.radius = part.radius + row.weights.dot(round.radii);
        find_part_giving_way(row, patch, round.centres);
        row.gap = touch.normal.dot(part.sphere.if_rigid->position() - part.sphere.device -
                                   dragged_off_of(tools_[t], part) -
                                   row.part_giving_way * part.touches[soft].sunk_free);
        for (Index i = 0; i < 3; ++i)
            row.gap += row.weights[i] *
                       row.normal.dot(patch.held_displacement(row.slots[static_cast<std::size_t>(i)]));
        rows_.push_back(row);
    }
}

// Triangles that no walk over the surface from those pressed would find in time: of another fold, or where
// other tools make tissue bulge.
void ContactEquilibrium::look_around(std::size_t t, std::size_t p, std::size_t soft) noexcept {
    const Tool& tool = tools_[t];
    Part& part = tools_[t].parts[p];
    Touch& touch = part.touches[soft];
    const DeformedPatch& patch = patches_[soft];
    const Vector3d centre = centre_of(tool, part, touch), from = part.sphere.if_rigid->position();
    const double limit = part.radius + tool.reach;
    const bool anew = touch.way < 0;
    if (anew) {
        touch.around.clear();
        touch.way = 0;
    } else {
        touch.way +=
            (centre - touch.last_centre).norm() + (touch.sunk - touch.last_sunk).norm() + last_motion_;
    }
    touch.last_centre = centre;
    touch.last_sunk = touch.sunk;
    if (anew ||
        (centre - touch.looked_to).norm() + (touch.sunk - touch.looked_sunk).norm() > look_margin / 2 ||
        (from - touch.looked_from).norm() > look_margin / 2) {
        const CollisionSurface& surface = *bodies_.surfaces[bodies_.rigid_count() + soft];
        std::array<std::int32_t, most_rows> slots;
        const std::size_t found =
            surface.slots_near(from, centre, limit + look_margin + touch.sunk.norm(), slots);
        // What was looked at before keeps its turn; both lists are in the tree's order. What is new is
        // farther off than it need be looked at, so not all of it is looked at in one tick.
        FixedList<Surrounding, most_rows> around;
        const Surrounding* known = touch.around.begin();
        double later = 0;
        for (const std::int32_t slot : std::span(slots).first(std::min(found, slots.size()))) {
            while (known != touch.around.end() && known->tree_slot < slot) ++known;
            if (known != touch.around.end() && known->tree_slot == slot) {
                around.push_back(*known);
                continue;
            }
            around.push_back({slot, surface.mesh_triangle(slot), touch.way + later});
            if (!anew) later = std::min(later + look_margin / 64, look_margin / 4);
        }
        touch.around = around;
        touch.looked_from = from;
        touch.looked_to = centre;
        touch.looked_sunk = touch.sunk;
    }
    // Half of what lies between what is solved and what is near: it is looked at again before it is solved.
    const double soon = limit - first_reach / 2;
    std::vector<std::uint32_t>& visited = visited_[soft];
    ++search_;
    for (const Near& near : touch.near) visited[near.triangle] = search_;
    for (Surrounding& near : touch.around) {
        if (near.due > touch.way || touch.near.full() || visited[near.triangle] == search_) continue;
        const NearestBall ball =
            nearest_ball(centre, patch.rounded(near.triangle, patch.look_at(near.triangle, touch.sunk)));
        const double distance = ball.distance - ball.radius;
        if (distance < soon) touch.near.push_back({.triangle = near.triangle});
        near.due = touch.way + std::max(0.0, distance - soon);
    }
}

// Measures how far a sphere and the tissue went since the round before; false if it was not gathered then, so
// that nothing is known of what is near.
bool ContactEquilibrium::follow(Touch& touch, const Vector3d& centre,
                                const DeformedPatch& patch) const noexcept {
    const bool follows = touch.gathered_in == round_ - 1;
    touch.gathered_way +=
        patch.step() + (centre - touch.gathered_centre).norm() + (touch.sunk - touch.gathered_sunk).norm();
    if (!follows) touch.gathered_way = 0;
    touch.gathered_in = round_;
    touch.gathered_centre = centre;
    touch.gathered_sunk = touch.sunk;
    return follows;
}

// The triangles near a sphere, walked to over the displaced surface from those that were near it last and
// from those on which it would rest, once others may have come near. Those that were too far off to be solved
// or watched, and cannot have come as near since, are passed over. Tells whether the centre is outside.
bool ContactEquilibrium::gather(std::size_t t, std::size_t p, std::size_t soft) noexcept {
    const Tool& tool = tools_[t];
    Part& part = tools_[t].parts[p];
    Touch& touch = part.touches[soft];
    DeformedPatch& patch = patches_[soft];
    const DeformableContact& body = patch.body();
    std::vector<std::uint32_t>& visited = visited_[soft];
    ++search_;
    queue_.clear();
    passed_over_.clear();
    bool found_all = true;
    const auto visit = [&](std::int32_t triangle) {
        if (visited[triangle] == search_) return;
        found_all = found_all && !queue_.full();
        if (queue_.full()) return;
        visited[triangle] = search_;
        queue_.push_back(triangle);
    };
    // What pressed stays even where an answer has led away from it: another may lead back.
    const auto pressed = [&](std::int32_t triangle) {
        return is_active(key_of(static_cast<std::int64_t>(t), static_cast<std::int64_t>(p),
                                static_cast<std::int64_t>(soft), triangle));
    };
    const Vector3d centre = centre_of(tool, part, touch);
    const bool follows = follow(touch, centre, patch);
    const bool walks = !follows || touch.gathered_way + tool.near > touch.walked_until;
    if (walks) touch.walked_until = touch.gathered_way + tool.reach;
    double nearest_passed = std::numeric_limits<double>::infinity();  // mm, at least
    for (const Near& near : touch.near) {
        const double distance = near.clear - touch.gathered_way;
        if (!follows || distance < tool.near || near.rounds == most_rounds || pressed(near.triangle)) {
            visit(near.triangle);
            continue;
        }
        visited[near.triangle] = search_;
        passed_over_.push_back({near.triangle, near.rounds + 1, near.clear});
        nearest_passed = std::min(nearest_passed, distance);
    }
    touch.near.clear();
    for (const GodObject::Touch& rests : part.sphere.if_rigid->touches())
        if (rests.surface == bodies_.rigid_count() + soft) visit(rests.foot.triangle);
    const std::size_t seeds = queue_.size();
    if (seeds == 0 && passed_over_.empty()) return true;
    if (walks)
        for (const Near& near : passed_over_)
            for (const std::int32_t neighbour : body.neighbours(near.triangle)) visit(neighbour);
    linearise(part.radius, touch, patch);
    const double limit = part.radius + tool.reach;
    FixedList<Vector3d, most_rows> shared;
    FixedList<double, most_rows> shared_distances;  // of these, which tell most of them apart
    struct Nearest {
        TriangleCorners centres;
        Vector3d centre;  // of the ball
    };
    FixedList<Nearest, max_contacts> nearest_ones;
    double nearest = limit;
    bool behind_held = false;
    for (std::size_t next = 0;; ++next) {
        if (next == queue_.size()) {
            if (nearest - part.radius + same_place <= nearest_passed) break;
            // Nothing else is as near.
            for (const Near& near : passed_over_)
                if (!queue_.full()) queue_.push_back(near.triangle);
            passed_over_.clear();
            nearest_passed = std::numeric_limits<double>::infinity();
            if (next == queue_.size()) break;
        }
        const std::int32_t triangle = queue_[next];
        std::array<std::int32_t, 3> slots;
        if (!patch.slots_of(triangle, slots)) {
            found_all = false;
            break;
        }
        const RoundedTriangle round = patch.rounded(triangle, patch.met_corners(slots, touch.sunk));
        const NearestBall ball = nearest_ball(centre, round);
        const double distance = ball.distance - ball.radius;
        const bool near = distance < limit || pressed(triangle);
        if (walks && (near || next < seeds))
            for (const std::int32_t neighbour : body.neighbours(triangle)) visit(neighbour);
        if (!near) {
            // Forgotten between two walks, it has to be found by one before it is near again.
            if (!walks)
                touch.walked_until =
                    std::min(touch.walked_until, touch.gathered_way + distance - part.radius);
            continue;
        }
        found_all = found_all && !touch.near.full();
        if (!touch.near.full())
            touch.near.push_back(
                {.triangle = triangle, .clear = touch.gathered_way + distance - part.radius});
        if (!(ball.distance > 0)) continue;
        const auto gives_way = [&](std::int32_t slot) { return patch.gives_way(slot); };
        // A sphere may press thin tissue down to what it is held by at its back.
        if (std::ranges::none_of(slots, gives_way) &&
            unit_normal(round.centres).dot(centre - ball.centre) < 0) {
            behind_held = true;
        } else if (distance < nearest + same_place) {
            if (distance < nearest - same_place) nearest_ones.clear();
            nearest = std::min(nearest, distance);
            if (!nearest_ones.full()) nearest_ones.push_back({round.centres, ball.centre});
        }
        // Triangles have points in common where these are not within one of them.
        if (ball.feature != Feature::face) {
            const auto same = [&](const Vector3d& other) {
                return (other - ball.centre).squaredNorm() < same_place * same_place;
            };
            bool as_far = false;
            for (const double other : shared_distances)
                as_far |= std::abs(other - ball.distance) < same_place;
            if (as_far && std::any_of(shared.begin(), shared.end(), same)) continue;
            if (!shared.full()) {
                shared.push_back(ball.centre);
                shared_distances.push_back(ball.distance);
            }
        }
        Row row;
        row.tool = static_cast<std::int32_t>(t);
        row.part = static_cast<std::int32_t>(p);
        row.patch = static_cast<std::int32_t>(soft);
        row.triangle = triangle;
        row.slots = slots;
        row.weights = ball.barycentric;
        row.normal = (centre - ball.centre) / ball.distance;
        row.radius = part.radius + ball.radius;
        row.distance = distance - part.radius;
        find_part_giving_way(row, patch, round.centres);
        row.gap = row.normal.dot(pressed_off_of(tool, part) +
                                 row.part_giving_way * (touch.sunk - touch.sunk_free)) -
                  row.distance;
        for (Index i = 0; i < 3; ++i) {
            const std::int32_t slot = row.slots[static_cast<std::size_t>(i)];
            row.gap -=
                row.weights[i] * row.normal.dot(patch.displacement(slot) - patch.held_displacement(slot));
        }
        auto& list = row.distance < tool.near || pressed(triangle) ? rows_ : watched_;
        if (!list.full()) list.push_back(row);
    }
    for (const Near& near : passed_over_) {
        found_all = found_all && !touch.near.full();
        if (!touch.near.full()) touch.near.push_back(near);
    }
    if (!found_all) touch.walked_until = std::numeric_limits<double>::lowest();
    if (nearest_ones.empty()) return !behind_held;
    Vector3d normal = Vector3d::Zero(), away = Vector3d::Zero();
    for (const Nearest& one : nearest_ones) {
        normal += angle_about(one.centre, one.centres) * unit_normal(one.centres);
        away = centre - one.centre;
    }
    return normal.dot(away) >= 0 || stays_outside(part, touch, patch, centre, nearest);
}

// Whether a sphere that was outside at the end of the last tick, and keeps clear of the surface now, went too
// short a way since to have passed through: what is nearest to it may be turned over, where tissue is folded.
bool ContactEquilibrium::stays_outside(const Part& part, const Touch& touch, const DeformedPatch& patch,
                                       const Vector3d& centre, double nearest) const noexcept {
    if (!touch.outside) return false;
    const double passage = part.radius / 2;
    // Vertices that nobody had looked at before move as those did in the last tick.
    const double way = (centre - touch.outside_centre).norm() + (touch.sunk - touch.outside_sunk).norm() +
                       std::max(patch.motion(), last_motion_);
    return nearest > passage && way < passage;
}

// Whether it pressed in the last solution.
bool ContactEquilibrium::is_active(std::int64_t key) const noexcept {
    const auto end = active_.begin() + static_cast<std::ptrdiff_t>(active_count_);
    return std::find(active_.begin(), end, key) != end;
}

// Whether the state keeps clear of the triangles that were not solved, to first order.
bool ContactEquilibrium::watched_are_clear() const noexcept {
    return std::ranges::all_of(watched_, [&](const Row& row) {
        const Tool& tool = tools_[static_cast<std::size_t>(row.tool)];
        const Touch& touch = touch_of(row);
        const DeformedPatch& patch = patch_of(row);
        const Part& part = part_of(row);
        double distance = row.normal.dot(pressed_off_of(tool, part) +
                                         row.part_giving_way * (touch.sunk - touch.sunk_free)) -
                          row.gap;
        for (Index i = 0; i < 3; ++i) {
            const std::int32_t slot = row.slots[static_cast<std::size_t>(i)];
            distance -=
                row.weights[i] * row.normal.dot(patch.displacement(slot) - patch.held_displacement(slot));
        }
        return distance > -settled;
    });
}

// Leaves as many rows as can be solved: each tool its nearest, in turn, and of those of one sphere the second
// after the nearest of all others, and so on.
void ContactEquilibrium::cut_rows() noexcept {
    if (rows_.size() <= max_contacts) return;
    const auto soft = rows_.begin() + static_cast<std::ptrdiff_t>(wall_count());
    for (auto row = soft; row != rows_.end(); ++row) row->place = static_cast<std::int32_t>(row - soft);
    const auto number = [&](const auto& of) {
        for (auto row = soft; row != rows_.end(); ++row)
            row->rank = row != soft && of(*std::prev(row)) == of(*row) ? std::prev(row)->rank + 1 : 0;
    };
    std::sort(soft, rows_.end(), [](const Row& a, const Row& b) {
        return std::tie(a.tool, a.part, a.distance, a.place) < std::tie(b.tool, b.part, b.distance, b.place);
    });
    number([](const Row& row) { return std::pair(row.tool, row.part); });
    std::sort(soft, rows_.end(), [](const Row& a, const Row& b) {
        return std::tie(a.tool, a.rank, a.distance, a.place) < std::tie(b.tool, b.rank, b.distance, b.place);
    });
    number([](const Row& row) { return row.tool; });
    std::sort(soft, rows_.end(),
              [](const Row& a, const Row& b) { return std::tie(a.rank, a.tool) < std::tie(b.rank, b.tool); });
    for (std::size_t k = max_contacts; k < rows_.size(); ++k)
        if (rows_[k].distance < -settled) tools_[static_cast<std::size_t>(rows_[k].tool)].cut = true;
    rows_.cut(max_contacts);
    std::sort(soft, rows_.end(), [](const Row& a, const Row& b) { return a.place < b.place; });
}

// Those of one sphere on one body lie together.
void ContactEquilibrium::group_rows() noexcept {
    const std::size_t walls = wall_count();
    // Of a tool that does not turn, its god-objects know what friction on walls does.
    group_rows(0, turns() ? walls : 0, wall_groups_);
    group_rows(walls, rows_.size(), groups_);
}

void ContactEquilibrium::group_rows(std::size_t first, std::size_t end,
                                    FixedList<Group, max_contacts>& groups) noexcept {
    groups.clear();
    for (std::size_t next = first; first < end; first = next) {
        const Row& row = rows_[first];
        const auto together = [&](const Row& other) {
            return std::tie(row.tool, row.part, row.patch) == std::tie(other.tool, other.part, other.patch);
        };
        while (next < end && together(rows_[next])) ++next;
        groups.push_back({row.tool, row.part, row.patch, first, next});
    }
}

std::int64_t ContactEquilibrium::key_of(const Row& row) noexcept {
    return key_of(row.tool, row.part, row.patch, row.triangle);
}

// What is left of a wall's gap once tissue drags the tool.
double ContactEquilibrium::gap_of_wall(const Row& row) const noexcept {
    const Tool& tool = tools_[static_cast<std::size_t>(row.tool)];
    const double gap = row.gap - row.normal.dot(tool.drag) / coupling_;
    if (!turns()) return gap;
    // What turning moves the sphere beyond what is in proportion to what presses it.
    const Part& part = part_of(row);
    return gap - row.normal.dot(off_of(tool, part) - tool.off -
                                (tool.turn - tool.unpressed_turn).cross(part.swung));
}

// The slots of all rows, each once, whatever patch they are of.
void ContactEquilibrium::find_slots_of_rows() noexcept {
    slots_of_rows_.clear();
    std::bitset<static_cast<std::size_t>(DeformedPatch::most_vertices)> known;
    for (const Row& row : rows_) {
        if (row.patch < 0) continue;
        for (const std::int32_t slot : row.slots)
            if (!known[static_cast<std::size_t>(slot)]) {
                known[static_cast<std::size_t>(slot)] = true;
                slots_of_rows_.push_back(slot);
            }
    }
}

void ContactEquilibrium::solve_rows() noexcept {
    const std::size_t n = rows_.size();
    solves_ = 1;
    if (turns()) find_levers();
    find_slots_of_rows();
    std::array<std::size_t, max_contacts> warm;
    std::size_t warm_count = 0;
    for (std::size_t k = 0; k < n; ++k) {
        lcp_.gaps()[static_cast<Index>(k)] = rows_[k].wall ? gap_of_wall(rows_[k]) : rows_[k].gap;
        if (is_active(key_of(rows_[k]))) warm[warm_count++] = k;
    }
    for (std::size_t k = 0; k < neighbours_.row_count(); ++k) {
        lcp_.gaps()[static_cast<Index>(n + k)] = neighbours_.gap(k);
        if (neighbours_.is_active(k)) warm[warm_count++] = n + k;
    }
    residual_ = lcp_.solve(n + neighbours_.row_count(), std::span(warm).first(warm_count),
                           [&](std::size_t row) { fill_any_column(row); });
    take_forces();
    if (friction_.any()) {
        find_rubbing();
        if (rubbing_.size() > 1 || turns()) hold_together();
    }
    neighbours_.take({lcp_.forces().data() + n, neighbours_.row_count()});
}

void ContactEquilibrium::fill_any_column(std::size_t row) noexcept {
    row < rows_.size() ? fill_column(row) : fill_neighbours_column(row - rows_.size());
}

void ContactEquilibrium::take_forces() noexcept {
    active_count_ = 0;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        rows_[k].force = lcp_.forces()[static_cast<Index>(k)];
        if (rows_[k].force > 0) active_[active_count_++] = key_of(rows_[k]);
    }
}

// How far a force of one row opens the others.
void ContactEquilibrium::fill_column(std::size_t l) noexcept {
    const Row& pressing = rows_[l];
    const Vector3d off = pressing.normal / coupling_;
    Vector3d sunk = Vector3d::Zero();
    if (pressing.patch >= 0) {
        const DeformedPatch& patch = patch_of(pressing);
        if (neighbours_.row_count() > 0)
            patch.yield(pressing.slots, pressing.weights, pressing.normal, field_);
        else
            patch.yield(pressing.slots, pressing.weights, pressing.normal, slots_of_rows_, field_);
        sunk = pressing.part_giving_way * (touch_of(pressing).sinking * pressing.normal);
    }
    double* column = &lcp_.matrix()(0, static_cast<Index>(l));
    for (const Row& row : rows_) {
        Vector3d opens = Vector3d::Zero();
        if (row.tool == pressing.tool) opens = off;
        if (row.patch >= 0 && row.patch == pressing.patch) {
            opens += DeformedPatch::mean(field_, row.slots, row.weights);
            if (row.tool == pressing.tool && row.part == pressing.part)
                opens += row.part_giving_way * sunk;
            else if (row.tool == pressing.tool)
                opens += row.part_giving_way * pressing.part_giving_way * shared_by(pressing, row.part) *
                         pressing.normal;
        }
        *column++ = row.normal.dot(opens);
    }
    if (turns()) add_levers(l);
    for (std::size_t k = 0; k < neighbours_.row_count(); ++k)
        *column++ = pressing.patch >= 0 ? neighbours_.closing(k, pressing.patch, field_) : 0;
}

// The same of a row between bodies beside each other.
void ContactEquilibrium::fill_neighbours_column(std::size_t k) noexcept {
    double* column = &lcp_.matrix()(0, static_cast<Index>(rows_.size() + k));
    for (const Row& row : rows_)
        *column++ = row.patch < 0 ? 0
                                  : neighbours_.compliance_to_tool(patches_, k, row.patch, row.slots,
                                                                   row.weights, row.normal);
    const std::span<const double> compliances = neighbours_.compliances(patches_, k);
    std::ranges::copy(compliances, column);
}

}  // namespace palpate::haptics
