// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/deformable_contact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/model/errors.hpp"

// Contact of a sphere (centre d, radius r) with an elastic body, given its compliance.
//
// The god-object of radius r on the rest surface has its centre at p, at rest where the tool would be if the
// body were rigid. Contact points k are
//   - the feet: the surface points x_k on which the god-object rests, with n_k = (p - x_k) / |p - x_k|, and
//   - the free surface vertices x_k in the tool's way from p to d: with a = (p - d) / |p - d|, those at a
//   distance
//     rho < r from the axis through d along a, below p, and facing a. The tool meets such a vertex where its
//     sphere passes: n_k = (sqrt(r² - rho²) a - t_k) / r, where t_k is the vertex' offset from the axis,
//     |t_k| = rho.
// n_k is the sphere's unit normal at the contact, from tissue to tool. Without friction, tissue may slide
// along the sphere, so only the way along n_k is prescribed: the displaced point x_k + u_k must leave the
// half-space beyond the sphere's tangent plane,
//     -n_k . (x_k + u_k - d) >= r   <=>   -n_k . u_k >= delta_k,    delta_k = r + n_k . (x_k - d).
// For a foot in equilibrium delta = |p - d|. A vertex at the rim (rho -> r) has n_k square to the axis and
// delta_k -> 0. (Prescribing the way along a for all points instead demands |p - d| - r at the rim at once,
// and drags walls along that the tool only slides past.)
//
// The tool pushes point k by -n_k f_k, f_k >= 0, spread over its vertices i by their weights w_ki (1 for a
// vertex). With the compliance C, u_k = -sum_l f_l sum_ij w_ki w_lj C_ij n_l, fixed vertices giving nothing,
// so that
//     A f - delta >= 0,  f >= 0,  f . (A f - delta) = 0,    A_kl = sum_ij w_ki w_lj n_k . C_ij n_l.
// A is symmetric positive semi-definite. The device feels sum_k f_k n_k.
//
// Two compliances are put in series with a point's own, c_k on the diagonal of A, and written into the
// contact:
//   - No point is stiffer than the virtual coupling: if A_kk is below 1 / coupling_stiffness (a foot on fixed
//   vertices
//     has A_kk = 0), the difference. A wholly fixed foot feels like a rigid body, and the way there is
//     continuous.
//   - A vertex enters at the rim, where tissue drawn towards the axis may press on the tool at once. In the
//   outer part
//     of the footprint, where cos = n_k . a < 1/2 (rho > 0.87 r), it bears the less the nearer the rim:
//     A_kk (1 / (2 cos) - 1), which is 0 at cos = 1/2 and grows without bound towards the rim. Forces so
//     change continuously while the tool slides over the mesh.

namespace palpate {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t max_slots = 1024;                   // triangles looked at around the tool's way
constexpr double unsolved = 1e-3;                         // mm of residual that is reported
constexpr std::int64_t foot_key = std::int64_t{1} << 32;  // keys below are vertices

Vector3d normal_of(const Contact& contact) noexcept {
    return Eigen::Map<const Vector3f>(contact.normal.data()).cast<double>();
}

// Takes force off a vertex that is about to leave the footprint.
double rim_compliance(const Contact& contact, const Vector3d& axis, double own) noexcept {
    if (contact.triangle >= 0) return 0;
    const double cosine = std::max(1e-6, normal_of(contact).dot(axis));
    return own * std::max(0.0, 0.5 / cosine - 1);
}

}  // namespace

DeformableContact::DeformableContact(const DeformableBody& body, std::int32_t body_index,
                                     const HapticSettings& settings)
    : body_index_(body_index),
      tool_radius_(settings.tool_radius),
      coupling_compliance_(1 / settings.coupling_stiffness),
      compliance_(body.compliance),
      triangles_(body.boundary.surface.triangles) {
    if (static_cast<std::size_t>(node_count(compliance_)) != body.contact_nodes.size())
        throw InvalidInput(
            {.culprit = body.name,
             .found = "its compliance has " + std::to_string(node_count(compliance_)) + " nodes",
             .expected = std::to_string(body.contact_nodes.size()),
             .next_step = "condense it again with 'palpate condense'"});
    for (const std::int32_t node : body.boundary.nodes) {
        const auto found = std::ranges::lower_bound(body.contact_nodes, node);
        const bool free = found != body.contact_nodes.end() && *found == node;
        blocks_.push_back(free ? static_cast<std::int32_t>(found - body.contact_nodes.begin()) : -1);
    }
    for (const Vector3d& vertex : body.boundary.surface.vertices) vertices_.push_back(vertex.cast<float>());
    vertex_normals_.assign(vertices_.size(), Vector3f::Zero());
    for (const Triangle& t : triangles_) {
        const auto at = [&](std::size_t corner) { return static_cast<std::size_t>(t[corner]); };
        const Vector3f area =
            (vertices_[at(1)] - vertices_[at(0)]).cross(vertices_[at(2)] - vertices_[at(0)]);
        for (std::size_t corner = 0; corner < 3; ++corner) vertex_normals_[at(corner)] += area;
    }
}

// Fills `points` with the feet, then the vertices in the tool's way; returns how many.
std::size_t DeformableContact::collect(const CollisionSurface& surface, const GodObject& god_object,
                                       const Vector3d& device, std::span<Contact> points,
                                       std::uint32_t& status) noexcept {
    const double r = tool_radius_;
    std::size_t count = 0;
    const auto add = [&](Contact contact, const Vector3d& point, const Vector3d& normal) {
        const double gap = r + normal.dot(point - device);
        if (!(gap > 0)) return;
        contact.body = body_index_;
        Eigen::Map<Vector3f>(contact.normal.data()) = normal.cast<float>();
        contact.gap = static_cast<float>(gap);
        if (count < points.size()) {
            points[count++] = contact;
            return;
        }
        status |= contacts_cut;
        if (points.empty()) return;
        Contact& shallowest = *std::ranges::min_element(points, {}, &Contact::gap);
        if (shallowest.gap < contact.gap) shallowest = contact;
    };

    for (const GodObject::Touch& touch : god_object.touches()) {
        Contact contact;
        contact.triangle = touch.foot.triangle;
        contact.vertices = triangles_[static_cast<std::size_t>(contact.triangle)];
        Eigen::Map<Vector3f>(contact.weights.data()) = touch.foot.barycentric.cast<float>();
        add(contact, touch.foot.point, touch.normal);
    }

    const Vector3d& p = god_object.position();
    const double depth = (p - device).norm();
    const Vector3d axis = (p - device) / depth;
    std::array<std::int32_t, max_slots> slots;
    std::size_t found = surface.slots_near(device, p, r, slots);
    if (found > slots.size()) status |= contacts_cut;
    found = std::min(found, slots.size());
    for (std::size_t s = 0; s < found; ++s)
        for (const std::int32_t v : triangles_[static_cast<std::size_t>(surface.mesh_triangle(slots[s]))]) {
            const auto vertex = static_cast<std::size_t>(v);
            if (blocks_[vertex] < 0) continue;
            const Vector3d offset = vertices_[vertex].cast<double>() - device;
            const double height = offset.dot(axis);
            const Vector3d lateral = offset - height * axis;
            const double squared_rim = r * r - lateral.squaredNorm();
            if (squared_rim <= 0 || height > depth) continue;
            if (vertex_normals_[vertex].cast<double>().dot(axis) <= 0) continue;
            const auto seen = [&](const Contact& c) { return c.triangle < 0 && c.vertices[0] == v; };
            if (std::any_of(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count), seen))
                continue;
            Contact contact;
            contact.triangle = -1;
            contact.vertices = {v, -1, -1};
            contact.weights = {1, 0, 0};
            add(contact, device + offset, (std::sqrt(squared_rim) * axis - lateral) / r);
        }
    return count;
}

double DeformableContact::compliance_between(const Contact& a, const Contact& b) const noexcept {
    const Vector3d n_a = normal_of(a), n_b = normal_of(b);
    double sum = 0;
    for (std::size_t i = 0; i < 3 && a.vertices[i] >= 0; ++i) {
        const std::int32_t block_i = blocks_[static_cast<std::size_t>(a.vertices[i])];
        if (block_i < 0) continue;
        for (std::size_t j = 0; j < 3 && b.vertices[j] >= 0; ++j) {
            const std::int32_t block_j = blocks_[static_cast<std::size_t>(b.vertices[j])];
            if (block_j < 0) continue;
            const double work = n_a.dot(compliance_block(compliance_, block_i, block_j).cast<double>() * n_b);
            sum += static_cast<double>(a.weights[i]) * static_cast<double>(b.weights[j]) * work;
        }
    }
    return sum;
}

DeformableContact::Outcome DeformableContact::solve(const CollisionSurface& surface,
                                                    const GodObject& god_object, const Vector3d& device,
                                                    std::array<Contact, max_contacts>& contacts,
                                                    std::int32_t& contact_count) noexcept {
    Outcome outcome;
    if (god_object.touches().empty()) {
        last_active_count_ = 0;
        return outcome;
    }
    const std::span<Contact> free_part = std::span(contacts).subspan(static_cast<std::size_t>(contact_count));
    const std::size_t n = collect(surface, god_object, device, free_part, outcome.status);
    const std::span<Contact> points = free_part.first(n);
    const Vector3d axis = (god_object.position() - device).normalized();

    std::array<std::size_t, max_contacts> warm;
    std::size_t warm_count = 0;
    std::int64_t feet = 0;
    std::array<std::int64_t, max_contacts> keys;
    for (std::size_t k = 0; k < n; ++k) {
        keys[k] = points[k].triangle < 0 ? points[k].vertices[0] : foot_key + feet++;
        const auto end = last_active_.begin() + static_cast<std::ptrdiff_t>(last_active_count_);
        if (std::find(last_active_.begin(), end, keys[k]) != end) warm[warm_count++] = k;
        lcp_.gaps()[static_cast<Index>(k)] = static_cast<double>(points[k].gap);
        for (std::size_t l = 0; l < k; ++l)
            lcp_.matrix()(static_cast<Index>(k), static_cast<Index>(l)) = lcp_.matrix()(
                static_cast<Index>(l), static_cast<Index>(k)) = compliance_between(points[k], points[l]);
        const double own = compliance_between(points[k], points[k]);
        const double series =
            std::max(0.0, coupling_compliance_ - own) + rim_compliance(points[k], axis, own);
        points[k].series_compliance = static_cast<float>(series);
        lcp_.matrix()(static_cast<Index>(k), static_cast<Index>(k)) = own + series;
    }

    outcome.residual = lcp_.solve(n, std::span(warm).first(warm_count));
    if (!(outcome.residual <= unsolved)) outcome.status |= contact_unsolved;
    last_active_count_ = 0;
    for (std::size_t k = 0; k < n; ++k) {
        const double force = lcp_.forces()[static_cast<Index>(k)];
        points[k].force = static_cast<float>(force);
        outcome.force += force * normal_of(points[k]);
        if (force > 0) last_active_[last_active_count_++] = keys[k];
    }
    contact_count += static_cast<std::int32_t>(n);
    return outcome;
}

void DeformableContact::surface_displacement(std::span<const Contact> contacts,
                                             std::span<Vector3f> displacements) const noexcept {
    std::ranges::fill(displacements, Vector3f::Zero());
    std::array<NodeForce, 3 * max_contacts> forces;
    std::size_t count = 0;
    for (const Contact& contact : contacts) {
        if (contact.body != body_index_ || !(contact.force > 0)) continue;
        const Vector3f push = -contact.force * Eigen::Map<const Vector3f>(contact.normal.data());
        for (std::size_t i = 0; i < 3 && contact.vertices[i] >= 0; ++i)
            if (const std::int32_t block = blocks_[static_cast<std::size_t>(contact.vertices[i])];
                block >= 0 && count < forces.size())
                forces[count++] = {block, contact.weights[i] * push};
    }
    const auto contact_nodes = static_cast<std::size_t>(node_count(compliance_));
    add_displacements(compliance_, std::span(forces).first(count), displacements.first(contact_nodes));
    // Contact nodes are surface vertices in the same order, so that each goes up to its vertex in place.
    for (std::size_t v = displacements.size(); v-- > 0;)
        displacements[v] =
            blocks_[v] >= 0 ? displacements[static_cast<std::size_t>(blocks_[v])] : Vector3f::Zero();
}

}  // namespace palpate
