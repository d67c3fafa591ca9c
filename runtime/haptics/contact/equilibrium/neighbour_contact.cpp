// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/equilibrium/neighbour_contact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <tuple>

// Bodies beside each other keep apart as tools and tissue do (contact_equilibrium.cpp): to what comes to rest
// at the least energy belongs, for each candidate vertex a of one body and each triangle t of the other,
//     g_at = |y_a(u) - q_t(u)| - r >= 0,    y_a(u) = p_a + u_a + arm_a,
// q_t the point closest to y_a on the triangle as it is displaced. y_a is the centre of a ball of radius r
// that touches the vertex from behind, as the other body sees it: so directions change smoothly where it
// slides over an edge. Bodies cut from one label map touch or overlap a little at rest; there the arm is
// longer, so that what overlaps at rest does not press. The gradient of g_at is n by u_a and -w_i n by the
// corners' u_i, n = (y_a - q_t) / |y_a - q_t|. Linearised at the present state, row k of the complementarity
// problem has
//     A_kl = n_k . (C_A + sum_ij w_ki w_lj C_B,ij) n_l,
//     delta_k = n_k . (u_a - sum_i w_ki u_i) - g_k,
// and no coupling, for no tool takes part, and nothing sinks in locally, for two surfaces meet flat. They
// slide without friction, as serous ones do. Of a rigid body, C_B is zero.

namespace palpate::haptics {
namespace {

using namespace collision;
using Eigen::Index;
using Eigen::Vector3d;

constexpr double settled = 1e-4;         // mm: changes smaller than this end the search for the equilibrium
constexpr double alike = 0.05;           // mm: triangles that are farther than the nearest by less count too
constexpr double beside_foot = 0.5;      // mm: edges nearer to the foot are walked across
constexpr double first_gap = 0.02;       // mm: what is nearer is looked after in every tick
constexpr double motions_ahead = 4;      // ticks for which a candidate that is not near keeps clear
constexpr double safety = 4;             // times what a candidate was seen to move
constexpr double least_mobility = 0.05;  // of the fastest place's motion
constexpr std::size_t ticks_in_turn = 10, least_looks = 8, most_admitted = 2;
constexpr std::int32_t left_to_tools = 96;  // vertices of a patch
// mm: rows are linear as long as surfaces move by less, for then a ball leaves them by less than slight_gap;
// and they are found anew in every tick.
constexpr double as_good_as_linear = 0.3;

}  // namespace

void NeighbourContact::forget() noexcept {
    near_.clear();
    rows_.clear();
    watched_.clear();
    cut_ = false;
    stale_ = true;
    for (Interface& interface : interfaces_) {
        interface.way = interface.motion = 0;
        interface.next = interface.first;
    }
    for (Probe& probe : probes_) {
        probe.place = probe.at_rest;
        probe.gap = probe.gap_at_rest;
        probe.due = probe.gap_at_rest - first_gap;
        probe.seen_way = 0;
        probe.seen.setZero();
        probe.near = false;
        probe.mobility = 1;
        probe.pressed = -1;
        probe.opens = 0;
    }
}

// How near a candidate is looked after in every tick, mm.
double NeighbourContact::ahead_of(const Probe& probe, const Interface& interface) noexcept {
    return first_gap + motions_ahead * probe.mobility * interface.motion;
}

// Whether a candidate is near; if not, says when it could be.
bool NeighbourContact::look_at(Probe& probe, std::span<const DeformedPatch> patches) noexcept {
    const Interface& interface = interfaces_[probe.interface];
    const DeformedPatch& patch = patches[static_cast<std::size_t>(interface.soft)];
    // The other surface is looked at where it rests, and the vertex where it is against its nearest place.
    Vector3d went = patch.look_at_vertex(probe.vertex) - patch.body().rest_position(probe.vertex);
    if (interface.other >= 0) {
        const DeformedPatch& other = patches[static_cast<std::size_t>(interface.other)];
        went -= other.look_at_vertex(probe.place.vertex) - other.body().rest_position(probe.place.vertex);
    }
    const Vector3d centre = patch.body().rest_position(probe.vertex) + probe.arm + went;
    const CollisionSurface& surface = *bodies_.surfaces[static_cast<std::size_t>(interface.body)];
    const auto nearest =
        surface.closest_point(centre, std::numeric_limits<double>::infinity(), probe.place.tree_slot);
    if (!nearest) return false;
    Index corner = 0;
    nearest->barycentric.maxCoeff(&corner);
    probe.place = {nearest->triangle, nearest->slot,
                   bodies_.triangles[static_cast<std::size_t>(interface.body)][static_cast<std::size_t>(
                       nearest->triangle)][static_cast<std::size_t>(corner)]};
    probe.gap =
        (surface.is_outside(centre, *nearest) ? nearest->distance : -nearest->distance) - probe.radius;
    const double way = interface.way - probe.seen_way;
    probe.mobility = way > 0 ? std::min(1.0, safety * (went - probe.seen).norm() / way + least_mobility) : 1;
    probe.seen = went;
    probe.seen_way = interface.way;
    probe.due = interface.way + (probe.gap - first_gap) / probe.mobility;
    return probe.gap < ahead_of(probe, interface);
}

void NeighbourContact::look(std::span<const DeformedPatch> patches) noexcept {
    stale_ = true;
    for (Interface& interface : interfaces_) {
        const auto rests = [&](std::int32_t patch) {
            return patch < 0 || patches[static_cast<std::size_t>(patch)].is_at_rest();
        };
        if (rests(interface.soft) && rests(interface.other)) continue;
        const std::size_t count = interface.end - interface.first;
        std::size_t looks = std::max(least_looks, count / ticks_in_turn + 1), admitted = 0;
        for (std::size_t k = 0; k < count && looks > 0 && admitted < most_admitted; ++k) {
            const std::size_t at = interface.next;
            interface.next = at + 1 == interface.end ? interface.first : at + 1;
            Probe& probe = probes_[at];
            if (probe.near || probe.due > interface.way) continue;
            --looks;
            if (!look_at(probe, patches) || near_.full()) continue;
            probe.near = true;
            near_.push_back(at);
            ++admitted;
        }
    }
}

// False where there is no room left for its vertices.
bool NeighbourContact::corners_of(const Interface& interface, std::span<DeformedPatch> patches,
                                  std::int32_t triangle, std::array<std::int32_t, 3>& slots,
                                  TriangleCorners& corners) const noexcept {
    if (interface.other < 0) {
        const CollisionSurface& surface = *bodies_.surfaces[static_cast<std::size_t>(interface.body)];
        corners = surface.corners(interface.tree_slots[static_cast<std::size_t>(triangle)]);
        return true;
    }
    DeformedPatch& patch = patches[static_cast<std::size_t>(interface.other)];
    const Triangle& vertices = patch.body().triangle(triangle);
    const auto is_in = [&](std::int32_t vertex) { return patch.is_in(vertex); };
    if (patch.room() < left_to_tools && !std::ranges::all_of(vertices, is_in)) return false;
    if (!patch.slots_of(triangle, slots)) return false;
    corners = patch.corners(slots);
    return true;
}

// The triangles about the place nearest to a ball, from one of them on.
NeighbourContact::Walked NeighbourContact::walk(const Interface& interface, std::span<DeformedPatch> patches,
                                                std::int32_t from, const Vector3d& centre) const noexcept {
    Walked walked;
    double nearest = std::numeric_limits<double>::infinity();
    FixedList<std::int32_t, most_walked> queue;
    queue.push_back(from);
    for (std::size_t next = 0; next < queue.size(); ++next) {
        Seen seen;
        seen.triangle = queue[next];
        TriangleCorners corners;
        if (!corners_of(interface, patches, seen.triangle, seen.slots, corners)) continue;
        seen.closest = closest_point_on_triangle(centre, corners);
        seen.distance = std::sqrt(seen.closest.squared_distance);
        if (seen.distance > nearest + alike) continue;
        nearest = std::min(nearest, seen.distance);
        const Vector3d face = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        seen.corners = corners;
        walked.push_back(seen);
        const std::array<std::int32_t, 3>& across =
            interface.other < 0
                ? interface.neighbours[static_cast<std::size_t>(seen.triangle)]
                : patches[static_cast<std::size_t>(interface.other)].body().neighbours(seen.triangle);
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Vector3d edge = corners[(corner + 1) % 3] - corners[corner];
            const double height =
                seen.closest.barycentric[static_cast<Index>((corner + 2) % 3)] * face.norm();
            if (height > beside_foot * edge.norm() || queue.full()) continue;
            if (std::find(queue.begin(), queue.end(), across[corner]) == queue.end())
                queue.push_back(across[corner]);
        }
    }
    return walked;
}

// The rows of one candidate that is near.
void NeighbourContact::meet(std::size_t p, std::span<DeformedPatch> patches) noexcept {
    Probe& probe = probes_[p];
    const Interface& interface = interfaces_[probe.interface];
    DeformedPatch& patch = patches[static_cast<std::size_t>(interface.soft)];
    Row row;
    row.probe = p;
    if (!patch.is_in(probe.vertex) && patch.room() < left_to_tools) {
        cut_ = cut_ || probe.gap < -slight_gap;
        return;
    }
    row.slot = patch.slot_of(probe.vertex);
    const Vector3d centre = patch.position(row.slot) + probe.arm;
    const Walked walked = walk(interface, patches, probe.place.triangle, centre);
    if (walked.empty()) {
        cut_ = cut_ || probe.gap < -slight_gap;
        return;
    }
    const Seen& nearest = *std::min_element(
        walked.begin(), walked.end(), [](const Seen& a, const Seen& b) { return a.distance < b.distance; });
    Vector3d normal = Vector3d::Zero();
    for (const Seen& seen : walked)
        if (seen.distance < nearest.distance + same_place)
            normal += angle_about(seen.closest.point, seen.corners) * unit_normal(seen.corners);
    const bool outside = normal.dot(centre - nearest.closest.point) >= 0;
    probe.place.triangle = nearest.triangle;
    probe.gap = (outside ? nearest.distance : -nearest.distance) - probe.radius;
    const std::size_t first = rows_.size(), first_watched = watched_.size();
    for (const Seen& seen : walked) {
        if (outside ? seen.distance > nearest.distance + alike : seen.triangle != nearest.triangle) continue;
        row.triangle = seen.triangle;
        row.slots = seen.slots;
        row.weights = seen.closest.barycentric;
        row.point = seen.closest.point;
        row.distance = (outside ? seen.distance : -seen.distance) - probe.radius;
        row.normal = seen.distance > same_place
                         ? Vector3d((outside ? 1 : -1) * (centre - seen.closest.point) / seen.distance)
                         : unit_normal(seen.corners);
        const auto same = [&](const Row& other) {
            return (other.point - row.point).squaredNorm() < same_place * same_place;
        };
        if (std::any_of(rows_.begin() + first, rows_.end(), same) ||
            std::any_of(watched_.begin() + first_watched, watched_.end(), same))
            continue;
        row.gap = parted(row, patches) - row.distance;
        const bool pressed = probe.pressed == row.triangle;
        row.worth = (pressed ? probe.opens : 0) - row.distance;
        auto& list = pressed || row.distance < 2 * probe.mobility * interface.motion ? rows_ : watched_;
        if (!list.full()) list.push_back(row);
    }
}

void NeighbourContact::gather(std::span<DeformedPatch> patches, std::size_t room) noexcept {
    if (!stale_ && rows_.size() <= room) return;
    rows_.clear();
    watched_.clear();
    cut_ = stale_ = false;
    moved_ = 0;
    for (const std::size_t probe : near_) meet(probe, patches);
    cut_rows(std::min(room, most_rows));
    known_.reset();
}

void NeighbourContact::move(double way) noexcept {
    moved_ += way;
    stale_ = stale_ || moved_ > as_good_as_linear;
}

// Leaves those without which bodies would overlap most.
void NeighbourContact::cut_rows(std::size_t room) noexcept {
    if (rows_.size() <= room) return;
    std::sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) {
        return std::tie(b.worth, a.probe, a.triangle) < std::tie(a.worth, b.probe, b.triangle);
    });
    for (std::size_t k = room; k < rows_.size(); ++k) {
        cut_ = cut_ || rows_[k].distance < -slight_gap;
        probes_[rows_[k].probe].pressed = -1;
    }
    rows_.cut(room);
}

double NeighbourContact::parted(const Row& row, std::span<const DeformedPatch> patches) const noexcept {
    const Interface& interface = interface_of(row);
    const auto free = [&](std::int32_t patch, std::int32_t slot) -> Vector3d {
        const DeformedPatch& on = patches[static_cast<std::size_t>(patch)];
        return on.displacement(slot) - on.held_displacement(slot);
    };
    Vector3d apart = free(interface.soft, row.slot);
    for (std::size_t i = 0; i < 3 && interface.other >= 0; ++i)
        apart -= row.weights[static_cast<Index>(i)] * free(interface.other, row.slots[i]);
    return row.normal.dot(apart);
}

double NeighbourContact::compliance_to_tool(std::span<const DeformedPatch> patches, std::size_t k,
                                            std::int32_t patch, const std::array<std::int32_t, 3>& slots,
                                            const Vector3d& weights, const Vector3d& normal) const noexcept {
    const Row& row = rows_[k];
    const Interface& interface = interface_of(row);
    const DeformedPatch& on = patches[static_cast<std::size_t>(patch)];
    Eigen::Vector3f apart = Eigen::Vector3f::Zero();
    if (patch == interface.soft) apart -= on.yielding(row.slot, slots, weights, normal);
    for (std::size_t i = 0; i < 3 && patch == interface.other; ++i)
        if (const double weight = row.weights[static_cast<Index>(i)]; weight > 0)
            apart += static_cast<float>(weight) * on.yielding(row.slots[i], slots, weights, normal);
    return row.normal.dot(apart.cast<double>());
}

std::span<const double> NeighbourContact::compliances(std::span<const DeformedPatch> patches,
                                                      std::size_t l) noexcept {
    auto column = compliance_.col(static_cast<Index>(l));
    if (!known_[l]) {
        known_[l] = true;
        column.setZero();
        const Row& row = rows_[l];
        const Interface& interface = interface_of(row);
        add_compliance(patches, interface.soft, l, {row.slot, 0, 0}, Vector3d::UnitX(), row.normal);
        if (interface.other >= 0)
            add_compliance(patches, interface.other, l, row.slots, row.weights, -row.normal);
    }
    return {column.data(), rows_.size()};
}

double NeighbourContact::closing(std::size_t k, std::int32_t patch,
                                 const DeformedPatch::Field& moved) const noexcept {
    const Row& row = rows_[k];
    const Interface& interface = interface_of(row);
    Vector3d closer = Vector3d::Zero();
    if (patch == interface.soft) closer += moved[static_cast<std::size_t>(row.slot)].head<3>().cast<double>();
    if (patch == interface.other) closer -= DeformedPatch::mean(moved, row.slots, row.weights);
    return -row.normal.dot(closer);
}

// What row l's `force` on a patch, shared out to three vertices, opens each row by.
void NeighbourContact::add_compliance(std::span<const DeformedPatch> patches, std::int32_t patch,
                                      std::size_t l, const std::array<std::int32_t, 3>& loaded,
                                      const Vector3d& shares, const Vector3d& force) noexcept {
    const DeformedPatch& on = patches[static_cast<std::size_t>(patch)];
    std::array<Eigen::Vector3f, DeformedPatch::most_vertices> moved;
    std::bitset<DeformedPatch::most_vertices> known;
    const auto at = [&](std::int32_t slot) -> const Eigen::Vector3f& {
        const auto s = static_cast<std::size_t>(slot);
        if (!known[s]) {
            known[s] = true;
            moved[s] = on.yielding(slot, loaded, shares, force);
        }
        return moved[s];
    };
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        const Row& row = rows_[k];
        const Interface& interface = interface_of(row);
        Eigen::Vector3f apart = Eigen::Vector3f::Zero();
        if (interface.soft == patch) apart = at(row.slot);
        for (std::size_t i = 0; i < 3 && interface.other == patch; ++i)
            if (const double weight = row.weights[static_cast<Index>(i)]; weight > 0)
                apart -= static_cast<float>(weight) * at(row.slots[i]);
        compliance_(static_cast<Index>(k), static_cast<Index>(l)) += row.normal.dot(apart.cast<double>());
    }
}

void NeighbourContact::take(std::span<const double> forces) noexcept {
    for (const std::size_t probe : near_) probes_[probe].pressed = -1;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        rows_[k].force = forces[k];
        if (!(forces[k] > 0)) continue;
        Probe& probe = probes_[rows_[k].probe];
        const double opens = forces[k] * compliance_(static_cast<Index>(k), static_cast<Index>(k));
        if (probe.pressed >= 0 && probe.opens > opens) continue;
        probe.pressed = rows_[k].triangle;
        probe.opens = opens;
    }
}

void NeighbourContact::load_answer(std::span<DeformedPatch> patches, std::size_t iterate) const noexcept {
    for (const Row& row : rows_) {
        if (!(row.force > 0)) continue;
        const Interface& interface = interface_of(row);
        const Vector3d push = row.force * row.normal;
        patches[static_cast<std::size_t>(interface.soft)].load_answer(iterate, row.slot, push);
        if (interface.other < 0) continue;
        for (std::size_t i = 0; i < 3; ++i)
            if (const double weight = row.weights[static_cast<Index>(i)]; weight > 0)
                patches[static_cast<std::size_t>(interface.other)].load_answer(iterate, row.slots[i],
                                                                               -weight * push);
    }
}

bool NeighbourContact::is_clear(std::span<const DeformedPatch> patches) noexcept {
    const bool clear = std::all_of(watched_.begin(), watched_.end(),
                                   [&](const Row& row) { return parted(row, patches) - row.gap > -settled; });
    stale_ = stale_ || !clear;
    return clear;
}

void NeighbourContact::write_contacts(TickResult& result) const noexcept {
    for (const Row& row : rows_) {
        const auto used = static_cast<std::size_t>(result.contact_count);
        if (!(row.force > 0) || used == max_contacts) continue;
        const Interface& interface = interface_of(row);
        Contact contact;
        contact.body = interface.body;
        contact.part = -1;
        contact.other_body = bodies_.deformable[static_cast<std::size_t>(interface.soft)].body_index();
        contact.other_vertex = probe_of(row).vertex;
        contact.triangle = row.triangle;
        contact.vertices =
            bodies_
                .triangles[static_cast<std::size_t>(interface.body)][static_cast<std::size_t>(row.triangle)];
        Eigen::Map<Eigen::Vector3f>(contact.weights.data()) = row.weights.cast<float>();
        Eigen::Map<Eigen::Vector3f>(contact.normal.data()) = row.normal.cast<float>();
        contact.gap = static_cast<float>(row.gap);
        contact.force = static_cast<float>(row.force);
        result.contacts[used] = contact;
        ++result.contact_count;
    }
}

void NeighbourContact::end_tick(std::span<const DeformedPatch> patches) noexcept {
    for (Interface& interface : interfaces_) {
        interface.motion = patches[static_cast<std::size_t>(interface.soft)].motion();
        if (interface.other >= 0)
            interface.motion += patches[static_cast<std::size_t>(interface.other)].motion();
        interface.way += interface.motion;
    }
    // What has gone off is looked at from time to time again.
    near_.erase_if([&](std::size_t at) {
        Probe& probe = probes_[at];
        const Interface& interface = interfaces_[probe.interface];
        const double clear = first_gap + 2 * (ahead_of(probe, interface) - first_gap);
        if (probe.pressed >= 0 || probe.gap < clear) return false;
        probe.near = false;
        probe.due = interface.way + (probe.gap - first_gap) / 2;
        return true;
    });
}

}  // namespace palpate::haptics
