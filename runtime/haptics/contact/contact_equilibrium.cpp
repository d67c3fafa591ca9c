// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/contact_equilibrium.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "runtime/haptics/contact/local_indentation.hpp"

// Contact that keeps energy. A tool of spheres r about x + s_p hangs on its virtual coupling of stiffness K
// from the device d + s_p; u are the displacements of the bodies' surfaces, C their compliances. Both come to
// rest where
//     V = 1/2 K |x - d|² + 1/2 u . C^-1 u    is least under    g_t = |x + s_p - q_t(u)| - r >= 0
// for every sphere and every triangle t of the surface as it is *displaced*, q_t(u) its point closest to the
// sphere's centre. The force on the device is -dV/dd = K (x - d): its work round a closed loop is zero. Rest
// positions, anchors and smoothed normals have no part in it.
//
// g_t is differentiable wherever the centre is off the triangle, with the gradient n = (x + s_p - q_t) /
// |...| by x and -w_i n by u_i, where w are the barycentric weights of q_t. Linearised at the present x and
// u, the conditions for the forces f >= 0 that the triangles press with are
//     A f - delta >= 0,  f >= 0,  f . (A f - delta) = 0,
//     A_kl = n_k . n_l / K + sum_ij w_ki w_lj n_k . C_ij n_l,     delta_k = n_k . (x - d) - sum_i w_ki n_k .
//     u_i - g_k,
// the first sum only where k and l are of one tool, the second only where they lie on one body; a rigid body
// has the first alone. They give the next x = d + sum f n / K and u = -C sum w n f, and so on until neither
// changes. Where two sets of contacts would take turns for ever, steps get shorter.

namespace palpate::haptics {
namespace {

using namespace collision;
using Eigen::Index;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double settled = 1e-4;     // mm: changes smaller than this end the search
constexpr double same_place = 1e-6;  // mm: closest points nearer than this are one
constexpr double first_reach = 0.1;  // mm beyond a sphere within which triangles count, of a tool at rest
constexpr double cold_reach = 0.5;   // the same where contact starts
constexpr int warm_iterations = 24, cold_iterations = 60;
constexpr double largest_weight = 5;  // of one answer in a combination of several
constexpr double slight_press =
    1e-3;  // E* r²: about which sinking in is linearised where nothing is known yet
constexpr std::size_t most_walls = 48;  // leaves room for tissue
constexpr double look_margin = 1;       // mm: how much farther around is looked

// The angle of a triangle at a corner.
double angle_at(const TriangleCorners& t, std::size_t corner) noexcept {
    const Vector3d a = t[(corner + 1) % 3] - t[corner], b = t[(corner + 2) % 3] - t[corner];
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

// The weight of a triangle's normal in the pseudonormal at a point of it (Baerentzen, Aanaes 2005).
double angle_about(const TriangleCorners& t, const TrianglePoint& point) noexcept {
    constexpr double pi = 3.141592653589793;
    if (point.feature == Feature::face) return 2 * pi;
    if (point.feature == Feature::edge) return pi;
    Index corner = 0;
    point.barycentric.maxCoeff(&corner);
    return angle_at(t, static_cast<std::size_t>(corner));
}

}  // namespace

void ContactEquilibrium::reset() noexcept {
    for (std::size_t t = 0; t < tools_.size(); ++t) forget(t);
    for (DeformedPatch& patch : patches_) patch.reset();
    active_count_ = 0;
    last_motion_ = 0;
}

void ContactEquilibrium::forget(std::size_t t) noexcept {
    Tool& tool = tools_[t];
    tool.touching = tool.at_rest = false;
    tool.off.setZero();
    tool.press.setZero();
    tool.drag.setZero();
    for (Part& part : tool.parts)
        for (Touch& touch : part.touches) {
            touch.count = 0;
            touch.way = -1;
            touch.freedom = 1;
            touch.sunk.setZero();
            touch.push.setZero();
            touch.drag.setZero();
            touch.slip.setZero();
            touch.slid = touch.pressed = false;
        }
}

void ContactEquilibrium::begin_tick(double stiffness) noexcept {
    coupling_ = stiffness;
    rows_.clear();
    residual_ = 0;
    for (Tool& tool : tools_) {
        tool.felt = 0;
        tool.outside = true;
        tool.at_rest = false;
    }
    for (DeformedPatch& patch : patches_) patch.begin_tick();
}

void ContactEquilibrium::pull(std::size_t t, std::span<const Sphere> spheres) noexcept {
    Tool& tool = tools_[t];
    double moved = 0;
    bool meets = false;
    for (std::size_t p = 0; p < spheres.size(); ++p) {
        Part& part = tool.parts[p];
        part.last_device = part.sphere.device;
        moved = std::max(moved, (spheres[p].device - part.last_device).norm());
        part.sphere = spheres[p];
        for (const GodObject::Touch& touch : spheres[p].if_rigid->touches())
            meets = meets || touch.surface >= bodies_.rigid_count();
    }
    tool.felt = spheres.size();
    tool.cold = !tool.touching;
    tool.touching = tool.touching || meets;
    tool.reach = tool.cold ? cold_reach : first_reach + 2 * moved;
    tool.held_reach = tool.cold ? 0 : (tool.last_tip - tool.parts[0].last_device).norm() + moved;
    tool.off = tool.cold ? Vector3d::Zero() : Vector3d(tool.last_tip - spheres[0].device);
}

bool ContactEquilibrium::add_wall(std::size_t tool, Contact& contact) noexcept {
    const std::size_t walls = wall_count();
    if (walls == most_walls) return false;
    Row row;
    row.tool = static_cast<std::int32_t>(tool);
    row.part = contact.part;
    row.triangle = contact.triangle;
    row.normal = normal_of(contact);
    row.gap = static_cast<double>(contact.gap);
    row.wall = &contact;
    rows_.cut(walls);
    rows_.push_back(row);
    return true;
}

std::size_t ContactEquilibrium::wall_count() const noexcept {
    return static_cast<std::size_t>(
        std::ranges::count_if(rows_, [](const Row& row) { return row.wall != nullptr; }));
}

bool ContactEquilibrium::is_needed() const noexcept {
    return std::ranges::any_of(tools_, [](const Tool& tool) { return tool.felt > 0 && tool.touching; });
}

// How a sphere sinks in, about the press that was found last; before any, about a slight one.
void ContactEquilibrium::linearise(Touch& touch, const DeformedPatch& patch) const noexcept {
    touch.sunk_free.setZero();
    touch.sinking.setZero();
    const LoadSpread* spread = patch.body().spread();
    if (!spread) return;
    const double known = touch.push.norm(),
                 press = std::max(known, slight_press * spread->contact_modulus() * radius_ * radius_);
    const LocalIndentation local =
        local_indentation(press, radius_, spread->contact_modulus(), spread->radius());
    if (!(press > 0)) return;
    touch.sinking = touch.freedom * local.depth / press * Eigen::Matrix3d::Identity();
    if (known < press) return;
    const Vector3d axis = touch.push / known;
    touch.sinking += touch.freedom * (local.slope - local.depth / press) * axis * axis.transpose();
    touch.sunk_free = touch.freedom * (local.depth - local.slope * press) * axis;
}

// The feet on which a sphere rests if nothing gives way, with the surface at rest: where contact starts.
void ContactEquilibrium::gather_at_rest(std::size_t t, std::size_t p) noexcept {
    Part& part = tools_[t].parts[p];
    for (std::size_t soft = 0; soft < patches_.size(); ++soft) linearise(part.touches[soft], patches_[soft]);
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
        row.gap = touch.normal.dot(part.sphere.if_rigid->position() - part.sphere.device -
                                   tools_[t].drag / coupling_ - part.touches[soft].sunk_free);
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
    const double limit = radius_ + tool.reach;
    touch.way += (centre - touch.last_centre).norm() + last_motion_;
    touch.last_centre = centre;
    if (touch.way < 0 || (centre - touch.looked_to).norm() > look_margin / 2 ||
        (from - touch.looked_from).norm() > look_margin / 2) {
        const CollisionSurface& surface = *bodies_.surfaces[bodies_.rigid_count() + soft];
        std::array<std::int32_t, most_rows> slots;
        const std::size_t found = surface.slots_near(from, centre, limit + look_margin, slots);
        touch.around.clear();
        for (std::size_t i = 0; i < std::min(found, slots.size()); ++i)
            touch.around.push_back({surface.mesh_triangle(slots[i]), 0});
        touch.looked_from = from;
        touch.looked_to = centre;
        touch.way = 0;
    }
    for (Surrounding& near : touch.around) {
        if (near.due > touch.way || touch.count == touch.triangles.size()) continue;
        const TrianglePoint closest = closest_point_on_triangle(centre, patch.look_at(near.triangle));
        const double distance = std::sqrt(closest.squared_distance);
        if (distance < limit) touch.triangles[touch.count++] = near.triangle;
        near.due = touch.way + std::max(0.0, distance - limit);
    }
}

// The triangles near a sphere, walked to over the displaced surface from those that were near it last and
// from those on which it would rest. Tells whether the centre is outside.
bool ContactEquilibrium::gather(std::size_t t, std::size_t p, std::size_t soft) noexcept {
    const Tool& tool = tools_[t];
    Part& part = tools_[t].parts[p];
    Touch& touch = part.touches[soft];
    DeformedPatch& patch = patches_[soft];
    const DeformableContact& body = patch.body();
    linearise(touch, patch);
    const Vector3d centre = centre_of(tool, part, touch);
    const double limit = radius_ + tool.reach;
    std::vector<std::uint32_t>& visited = visited_[soft];
    ++search_;
    queue_.clear();
    const auto visit = [&](std::int32_t triangle) {
        if (visited[triangle] == search_ || queue_.full()) return;
        visited[triangle] = search_;
        queue_.push_back(triangle);
    };
    for (std::size_t i = 0; i < touch.count; ++i) visit(touch.triangles[i]);
    for (const GodObject::Touch& rests : part.sphere.if_rigid->touches())
        if (rests.surface == bodies_.rigid_count() + soft) visit(rests.foot.triangle);
    const std::size_t seeds = queue_.size(), first = rows_.size();
    double nearest = limit;
    Vector3d nearest_away = Vector3d::Zero(), nearest_normal = Vector3d::Zero();
    for (std::size_t next = 0; next < queue_.size(); ++next) {
        const std::int32_t triangle = queue_[next];
        Row row;
        if (!patch.slots_of(triangle, row.slots)) break;
        const TriangleCorners corners = patch.corners(row.slots);
        const TrianglePoint closest = closest_point_on_triangle(centre, corners);
        const double distance = std::sqrt(closest.squared_distance);
        const bool near = distance < limit;
        if (near || next < seeds)
            for (const std::int32_t neighbour : body.neighbours(triangle)) visit(neighbour);
        if (!near || !(distance > 0)) continue;
        row.normal = (centre - closest.point) / distance;
        if (distance < nearest + same_place) {
            if (distance < nearest - same_place) nearest_normal.setZero();
            nearest = std::min(nearest, distance);
            nearest_away = row.normal;
            nearest_normal += angle_about(corners, closest) * unit_normal(corners);
        }
        const auto same = [&](const Row& other) {
            return (other.point - closest.point).squaredNorm() < same_place * same_place;
        };
        if (rows_.full() ||
            std::any_of(rows_.begin() + static_cast<std::ptrdiff_t>(first), rows_.end(), same))
            continue;
        row.tool = static_cast<std::int32_t>(t);
        row.part = static_cast<std::int32_t>(p);
        row.patch = static_cast<std::int32_t>(soft);
        row.triangle = triangle;
        row.weights = closest.barycentric;
        row.point = closest.point;
        row.distance = distance - radius_;
        row.gap =
            row.normal.dot(tool.off - tool.drag / coupling_ + touch.sunk - touch.sunk_free) - row.distance;
        for (Index i = 0; i < 3; ++i) {
            const std::int32_t slot = row.slots[static_cast<std::size_t>(i)];
            row.gap -=
                row.weights[i] * row.normal.dot(patch.displacement(slot) - patch.held_displacement(slot));
        }
        rows_.push_back(row);
    }
    touch.count = 0;
    for (std::size_t i = first; i < rows_.size() && touch.count < touch.triangles.size(); ++i)
        touch.triangles[touch.count++] = rows_[i].triangle;
    return nearest_normal.dot(nearest_away) >= 0;
}

// Leaves as many rows as can be solved: each tool its nearest, in turn.
void ContactEquilibrium::cut_rows() noexcept {
    if (rows_.size() <= max_contacts) return;
    const auto soft = rows_.begin() + static_cast<std::ptrdiff_t>(wall_count());
    for (auto row = soft; row != rows_.end(); ++row) row->place = static_cast<std::int32_t>(row - soft);
    std::sort(soft, rows_.end(), [](const Row& a, const Row& b) {
        return std::tie(a.tool, a.distance, a.place) < std::tie(b.tool, b.distance, b.place);
    });
    for (auto row = soft; row != rows_.end(); ++row)
        row->rank = row != soft && std::prev(row)->tool == row->tool ? std::prev(row)->rank + 1 : 0;
    std::sort(soft, rows_.end(),
              [](const Row& a, const Row& b) { return std::tie(a.rank, a.tool) < std::tie(b.rank, b.tool); });
    for (std::size_t k = max_contacts; k < rows_.size(); ++k)
        if (rows_[k].distance < -settled) tools_[static_cast<std::size_t>(rows_[k].tool)].cut = true;
    rows_.cut(max_contacts);
    std::sort(soft, rows_.end(), [](const Row& a, const Row& b) { return a.place < b.place; });
}

std::int64_t ContactEquilibrium::key_of(const Row& row) noexcept {
    const std::int64_t side = (std::int64_t{row.tool} << 16) + (std::int64_t{row.part} << 8) + row.patch + 1;
    return (side << 32) + row.triangle;
}

void ContactEquilibrium::solve_rows() noexcept {
    const std::size_t n = rows_.size();
    std::array<std::size_t, max_contacts> warm;
    std::size_t warm_count = 0;
    const std::span last(active_.data(), active_count_);
    for (std::size_t k = 0; k < n; ++k) {
        const Row& a = rows_[k];
        const auto row = static_cast<Index>(k);
        lcp_.gaps()[row] = a.gap;
        std::array<Vector3f, 3> given;  // how the corners of a give way along its normal
        for (std::size_t l = 0; l <= k; ++l) {
            const Row& b = rows_[l];
            double sum = a.tool == b.tool ? a.normal.dot(b.normal) / coupling_ : 0;
            if (a.patch >= 0 && a.patch == b.patch) {
                const DeformedPatch& patch = patches_[static_cast<std::size_t>(a.patch)];
                Vector3d moved = Vector3d::Zero();
                for (Index i = 0; i < 3; ++i)
                    for (Index j = 0; j < 3; ++j)
                        if (a.weights[i] > 0 && b.weights[j] > 0)
                            moved += a.weights[i] * b.weights[j] *
                                     patch.response(a.slots[static_cast<std::size_t>(i)],
                                                    b.slots[static_cast<std::size_t>(j)], b.normal);
                if (a.tool == b.tool && a.part == b.part) moved += touch_of(a).sinking * b.normal;
                sum += a.normal.dot(moved);
            }
            lcp_.matrix()(row, static_cast<Index>(l)) = lcp_.matrix()(static_cast<Index>(l), row) = sum;
        }
        if (std::ranges::find(last, key_of(a)) != last.end()) warm[warm_count++] = k;
    }
    residual_ = lcp_.solve(n, std::span(warm).first(warm_count));
    active_count_ = 0;
    for (std::size_t k = 0; k < n; ++k) {
        rows_[k].force = lcp_.forces()[static_cast<Index>(k)];
        if (rows_[k].force > 0) active_[active_count_++] = key_of(rows_[k]);
    }
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
                touch.next_sunk[iterate].setZero();
            }
    for_each_touch([&](Tool&, Part&, Touch& touch, std::span<const Row> rows, DeformedPatch& patch) {
        const LoadSpread* spread = patch.body().spread();
        if (!spread) return;
        double free = 0, press = 0;
        for (const Row& row : rows) {
            touch.push += row.force * row.normal;
            press += row.force;
            for (std::size_t i = 0; i < 3; ++i)
                free += row.force * row.weights[static_cast<Index>(i)] *
                        spread->freedom(patch.body().triangle(row.triangle)[i]);
        }
        const double pushing = touch.push.norm();
        if (!(press > 0) || !(pushing > 0)) return;
        touch.freedom = free / press;
        touch.next_sunk[iterate] = touch.sunk_free + touch.sinking * touch.push;
        const LocalIndentation local =
            local_indentation(pushing, radius_, spread->contact_modulus(), spread->radius());
        const Vector3d wanted = touch.freedom * local.depth / pushing * touch.push;
        change = std::max(change, (wanted - touch.next_sunk[iterate]).lpNorm<Eigen::Infinity>());
    });
    return change;
}

// What the present forces make of tools and tissue; returns by how much that differs from where they are, mm.
double ContactEquilibrium::answer(std::size_t iterate) noexcept {
    for (Tool& tool : tools_) tool.next_off[iterate].setZero();
    for (DeformedPatch& patch : patches_) patch.begin_answer(iterate);
    for (const Row& row : rows_) {
        if (!(row.force > 0)) continue;
        const Vector3d push = row.force * row.normal;
        tools_[static_cast<std::size_t>(row.tool)].next_off[iterate] += push / coupling_;
        if (row.patch < 0) continue;
        DeformedPatch& patch = patches_[static_cast<std::size_t>(row.patch)];
        for (std::size_t i = 0; i < 3; ++i)
            if (const double weight = row.weights[static_cast<Index>(i)]; weight > 0)
                patch.load_answer(iterate, row.slots[i], -weight * push);
    }
    double change = sink(iterate);
    for (Tool& tool : tools_) {
        tool.press = coupling_ * tool.next_off[iterate];
        tool.next_off[iterate] += tool.drag / coupling_;
        if (tool.felt == 0) tool.off = tool.next_off[iterate];
        tool.difference[iterate] = tool.next_off[iterate] - tool.off;
        change = std::max(change, tool.difference[iterate].lpNorm<Eigen::Infinity>());
        for (Part& part : std::span(tool.parts).first(tool.felt))
            for (Touch& touch : part.touches) {
                touch.sunk_difference[iterate] = touch.next_sunk[iterate] - touch.sunk;
                change = std::max(change, touch.sunk_difference[iterate].lpNorm<Eigen::Infinity>());
            }
    }
    for (DeformedPatch& patch : patches_) change = std::max(change, patch.end_answer(iterate));
    return change;
}

// Calls take(touch, part, rows, patch) for the rows of each sphere on each body, which lie together.
template <typename Take>
void ContactEquilibrium::for_each_touch(const Take& take) noexcept {
    const std::span<const Row> rows(rows_.data(), rows_.size());
    for (std::size_t first = wall_count(), end = first; first < rows.size(); first = end) {
        const Row& row = rows[first];
        const auto together = [&](const Row& other) {
            return std::tie(row.tool, row.part, row.patch) == std::tie(other.tool, other.part, other.patch);
        };
        while (end < rows.size() && together(rows[end])) ++end;
        const auto soft = static_cast<std::size_t>(row.patch);
        Tool& tool = tools_[static_cast<std::size_t>(row.tool)];
        Part& part = tool.parts[static_cast<std::size_t>(row.part)];
        take(tool, part, part.touches[soft], rows.subspan(first, end - first), patches_[soft]);
    }
}

// Calls take(slot, share) for the vertices that bear a sphere, with their shares of the press.
template <typename Take>
void ContactEquilibrium::for_each_bearing(std::span<const Row> rows, double press, const Take& take) {
    for (const Row& row : rows)
        for (std::size_t i = 0; i < 3 && row.force > 0; ++i)
            if (const double weight = row.weights[static_cast<Index>(i)]; weight > 0)
                take(row.slots[i], weight * row.force / press);
}

// How far a sphere has gone past the tissue that bears it and was not held, mm.
Vector3d ContactEquilibrium::slip_of(const Tool& tool, const Part& part, const Touch& touch,
                                     std::span<const Row> rows, const DeformedPatch& patch) noexcept {
    Vector3d slip = touch.slip;
    if (touch.pressed) slip += part.sphere.device + tool.off - touch.rubbed_centre;
    for_each_bearing(rows, touch.press, [&](std::int32_t slot, double share) {
        if (touch.pressed) slip -= share * (patch.displacement(slot) - patch.displacement_before(slot));
    });
    return slip - touch.axis.dot(slip) * touch.axis;
}

// Friction, for what the present forces press with. Where a sphere presses, friction holds it and the tissue
// together: its drag is what undoes the way that they have gone past each other, along with the coupling and
// the tissue's own compliance, as far as Coulomb lets it.
void ContactEquilibrium::rub() noexcept {
    for (DeformedPatch& patch : patches_) patch.clear_held();
    for (Tool& tool : tools_) {
        tool.drag.setZero();
        for (Part& part : tool.parts)
            for (Touch& touch : part.touches) touch.press = 0;
    }
    for_each_touch(
        [&](Tool& tool, Part& part, Touch& touch, std::span<const Row> rows, DeformedPatch& patch) {
            Vector3d push = Vector3d::Zero();
            for (const Row& row : rows) {
                touch.press += row.force;
                push += row.force * row.normal;
            }
            if (!(touch.press > 0) || !(push.norm() > 0)) return;
            touch.axis = push.normalized();
            touch.drag -= touch.axis.dot(touch.drag) * touch.axis;
            const Vector3d slip = slip_of(tool, part, touch, rows, patch);
            if (const double way = slip.norm(); way > 0) {
                const Vector3d along = slip / way;
                double compliance = 1 / coupling_;
                for_each_bearing(rows, touch.press, [&](std::int32_t slot, double share) {
                    for_each_bearing(rows, touch.press, [&](std::int32_t loaded, double other) {
                        compliance += share * other * along.dot(patch.response(slot, loaded, along));
                    });
                });
                touch.drag -= slip / compliance;
            }
            const double wanted = touch.drag.norm();
            touch.slides = wanted > (touch.slid ? friction_.sliding : friction_.at_rest) * touch.press;
            if (touch.slides) touch.drag *= friction_.sliding * touch.press / wanted;
            for_each_bearing(rows, touch.press,
                             [&](std::int32_t slot, double share) { patch.hold(slot, -share * touch.drag); });
            tool.drag += touch.drag;
        });
    for (Tool& tool : tools_)
        for (Part& part : tool.parts)
            for (Touch& touch : part.touches)
                if (!(touch.press > 0)) touch.drag.setZero();
}

// The weights, summing to 1, with which the last `known` answers differ least from their states, as if
// answers were linear in states (Anderson 1965).
ContactEquilibrium::Weights ContactEquilibrium::mix(std::size_t newest, std::size_t known) const noexcept {
    constexpr std::size_t all = DeformedPatch::iterates;
    Weights weights{};
    weights[newest] = 1;
    if (known < 2) return weights;
    Eigen::Matrix<double, all, all> products = Eigen::Matrix<double, all, all>::Identity();
    Eigen::Matrix<double, all, 1> ones = Eigen::Matrix<double, all, 1>::Zero();
    for (std::size_t a = 0; a < known; ++a)
        for (std::size_t b = 0; b <= a; ++b) {
            const std::size_t i = (newest + all - a) % all, j = (newest + all - b) % all;
            double sum = 0;
            for (const Tool& tool : tools_) {
                sum += tool.difference[i].dot(tool.difference[j]);
                for (const Part& part : std::span(tool.parts).first(tool.felt))
                    for (const Touch& touch : part.touches)
                        sum += touch.sunk_difference[i].dot(touch.sunk_difference[j]);
            }
            for (const DeformedPatch& patch : patches_) sum += patch.product_of_differences(i, j);
            products(static_cast<Index>(a), static_cast<Index>(b)) =
                products(static_cast<Index>(b), static_cast<Index>(a)) = sum;
        }
    const auto n = static_cast<Index>(known);
    const double scale = products.topLeftCorner(n, n).trace();
    if (!(scale > 0)) return weights;
    products.topLeftCorner(n, n) /= scale;
    for (Index k = 0; k < n; ++k) {
        products(k, k) += 1e-10;
        ones[k] = 1;
    }
    const Eigen::Matrix<double, all, 1> solution = products.ldlt().solve(ones);
    const double sum = solution.head(n).sum();
    if (!(std::abs(sum) > 0) || !solution.allFinite()) return weights;
    for (std::size_t a = 0; a < known; ++a) {
        const double weight = solution[static_cast<Index>(a)] / sum;
        if (std::abs(weight) > largest_weight) {
            weights = {};
            weights[newest] = 1;
            return weights;
        }
        weights[(newest + all - a) % all] = weight;
    }
    return weights;
}

// Goes to a combination of answers, at most `longest` mm.
void ContactEquilibrium::relax_to(const Weights& weights, double longest) noexcept {
    const auto combined = [&](const Offsets& answers) {
        Vector3d to = Vector3d::Zero();
        for (std::size_t k = 0; k < weights.size(); ++k)
            if (weights[k] != 0) to += weights[k] * answers[k];
        return to;
    };
    double way = 0;
    for (const Tool& tool : tools_) way = std::max(way, (combined(tool.next_off) - tool.off).norm());
    const double step = way > longest ? longest / way : 1;
    for (Tool& tool : tools_) {
        tool.off += step * (combined(tool.next_off) - tool.off);
        for (Part& part : std::span(tool.parts).first(tool.felt))
            for (Touch& touch : part.touches) touch.sunk += step * (combined(touch.next_sunk) - touch.sunk);
    }
    for (DeformedPatch& patch : patches_) patch.relax_to(weights, step);
}

void ContactEquilibrium::solve() noexcept {
    const auto starts = [](const Tool& tool) { return tool.felt > 0 && tool.touching && tool.cold; };
    iterate(std::ranges::any_of(tools_, starts) ? cold_iterations : warm_iterations);
    // What was found from the last tick on may have led astray: then contact starts anew. And where that does
    // not lead to an equilibrium either, the surface at rest has to do.
    if (start_anew()) iterate(cold_iterations);
    if (start_anew()) {
        for (std::size_t t = 0; t < tools_.size(); ++t) tools_[t].at_rest = tools_[t].cold && !found(t);
        iterate(warm_iterations);
    }
}

// Lets the tools start anew that are not in equilibrium; false if there are none.
bool ContactEquilibrium::start_anew() noexcept {
    bool any = false;
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        Tool& tool = tools_[t];
        if (tool.felt == 0 || !tool.touching || found(t)) continue;
        any = true;
        const bool at_rest = tool.at_rest;
        forget(t);
        tool.touching = tool.cold = true;
        tool.at_rest = at_rest;
    }
    return any;
}

void ContactEquilibrium::iterate(int most) noexcept {
    std::size_t known = 0;
    double before = std::numeric_limits<double>::infinity();
    for (int iteration = 0; iteration < most; ++iteration) {
        rows_.cut(wall_count());
        double longest = cold_reach;
        bool predicts = false;
        for (std::size_t t = 0; t < tools_.size(); ++t) {
            Tool& tool = tools_[t];
            if (tool.felt == 0) continue;
            tool.outside = true;
            tool.cut = false;
            const bool starts = tool.touching && tool.cold && (iteration == 0 || tool.at_rest);
            for (std::size_t p = 0; p < tool.felt; ++p) {
                if (starts) gather_at_rest(t, p);
                for (std::size_t soft = 0; !starts && soft < patches_.size(); ++soft) {
                    if (!tool.touching && !patches_[soft].bears_force()) continue;
                    if (iteration == (tool.touching && tool.cold ? 1 : 0)) look_around(t, p, soft);
                    tool.outside = gather(t, p, soft) && tool.outside;
                }
            }
            predicts = predicts || starts;
            longest = std::min(longest, tool.reach);
        }
        cut_rows();
        solve_rows();
        const std::size_t newest = static_cast<std::size_t>(iteration) % DeformedPatch::iterates;
        if (friction_.at_rest > 0) rub();
        const double change = answer(newest);
        // An answer from far off says little about the next one, and one to surfaces at rest nothing.
        known = change > 10 * before ? 1 : std::min(known + 1, DeformedPatch::iterates);
        if (predicts) known = 0;
        before = change;
        relax_to(mix(newest, change < settled ? 1 : known),
                 predicts ? std::numeric_limits<double>::infinity() : longest);
        if (change < settled) break;
    }
}

// Alone, a tool that would rest on tissue if nothing gave way is pressed by it: without a force it has gone
// through.
bool ContactEquilibrium::found(std::size_t t) const noexcept {
    const Tool& tool = tools_[t];
    if (!tool.outside || tools_.size() > 1 || tool.press != Vector3d::Zero()) return tool.outside;
    for (const Part& part : std::span(tool.parts).first(tool.felt))
        for (const GodObject::Touch& touch : part.sphere.if_rigid->touches())
            if (touch.surface >= bodies_.rigid_count() &&
                (part.sphere.if_rigid->position() - part.sphere.device).norm() > first_reach)
                return false;
    return true;
}

Vector3d ContactEquilibrium::sunk(std::size_t t) const noexcept {
    Vector3d sum = Vector3d::Zero();
    for (const Touch& touch : tools_[t].parts[0].touches) sum += touch.sunk;
    return sum;
}

void ContactEquilibrium::write_contacts(std::size_t t, TickResult& result) const noexcept {
    for (const Row& row : rows_) {
        if (row.wall) {
            row.wall->force = static_cast<float>(row.force);
            continue;
        }
        const auto used = static_cast<std::size_t>(result.contact_count);
        if (row.tool != static_cast<std::int32_t>(t) || !(row.force > 0) || used == max_contacts) continue;
        const DeformableContact& body = patches_[static_cast<std::size_t>(row.patch)].body();
        Contact contact;
        contact.body = body.body_index();
        contact.part = row.part;
        contact.triangle = row.triangle;
        contact.vertices = body.triangle(row.triangle);
        Eigen::Map<Vector3f>(contact.weights.data()) = row.weights.cast<float>();
        Eigen::Map<Vector3f>(contact.normal.data()) = row.normal.cast<float>();
        const Touch& touch = touch_of(row);
        const double sunk = row.normal.dot(touch.sunk_free + touch.sinking * touch.push);
        contact.gap = static_cast<float>(row.gap + row.normal.dot(touch.sunk_free));
        contact.force = static_cast<float>(row.force);
        contact.series_compliance = static_cast<float>(sunk / row.force);
        if (touch.press > 0)
            Eigen::Map<Vector3f>(contact.friction.data()) =
                (row.force / touch.press * touch.drag).cast<float>();
        result.contacts[used] = contact;
        ++result.contact_count;
    }
}

void ContactEquilibrium::end_tick() noexcept {
    bool any = false;
    last_motion_ = 0;
    for (const DeformedPatch& patch : patches_) last_motion_ = std::max(last_motion_, patch.motion());
    for (std::size_t t = 0; t < tools_.size(); ++t) {
        Tool& tool = tools_[t];
        const auto presses = [&](const Row& row) {
            return row.tool == static_cast<std::int32_t>(t) && row.patch >= 0 && row.force > 0;
        };
        if (tool.felt == 0 || tool.at_rest || !found(t) || std::ranges::none_of(rows_, presses)) {
            forget(t);
            continue;
        }
        any = tool.touching = true;
        tool.last_tip = tool.parts[0].sphere.device + tool.off;
        if (!(friction_.at_rest > 0)) continue;
        for (Part& part : tool.parts)
            for (Touch& touch : part.touches)
                if (!(touch.press > 0)) touch.slid = touch.pressed = false;
    }
    if (friction_.at_rest > 0)
        for_each_touch(
            [&](Tool& tool, Part& part, Touch& touch, std::span<const Row> rows, DeformedPatch& patch) {
                if (!(touch.press > 0) || !tool.touching) return;
                touch.slip = touch.slides ? Vector3d::Zero() : slip_of(tool, part, touch, rows, patch);
                touch.slid = touch.slides;
                touch.pressed = true;
                touch.rubbed_centre = part.sphere.device + tool.off;
            });
    if (any) return;
    for (DeformedPatch& patch : patches_) patch.reset();
    active_count_ = 0;
    last_motion_ = 0;
}

}  // namespace palpate::haptics
