// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/deformable_contact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

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
// n_k is the sphere's unit normal at the contact, from tissue to tool. Tissue may slide along the sphere, so
// only the way along n_k is prescribed: the displaced point x_k + u_k must leave the half-space beyond the
// sphere's tangent plane,
//     -n_k . (x_k + u_k - d) >= r   <=>   -n_k . u_k >= delta_k,    delta_k = r + n_k . (x_k - d).
// For a foot in equilibrium delta = |p - d|. A vertex at the rim (rho -> r) has n_k square to the axis and
// delta_k -> 0. (Prescribing the way along a for all points instead demands |p - d| - r at the rim at once,
// and drags walls along that the tool only slides past.)
//
// The tool pushes point k by -n_k f_k, f_k >= 0, spread over its vertices i by their weights w_ki (1 for a
// vertex). With the compliance C, u_k = -sum_l f_l sum_ij w_ki w_lj C_ij n_l, fixed vertices giving nothing.
// The tool itself gives way on the virtual coupling of stiffness K: its centre is d + sum_l f_l n_l / K. So
//     A f - delta >= 0,  f >= 0,  f . (A f - delta) = 0,
//     A_kl = sum_ij w_ki w_lj n_k . C_ij n_l + n_k . n_l / K,
// the first sum only where k and l lie on one body, the second only where they belong to one tool. A point of
// a rigid body has the second alone. A is symmetric positive semi-definite. The device feels sum_k f_k n_k,
// never stiffer than K.
//
// A vertex enters at the rim, where tissue drawn towards the axis may press on the tool at once. In the outer
// part of the footprint, where cos = n_k . a < 1/2 (rho > 0.87 r), it bears the less the nearer the rim: a
// compliance C_kk (1 / (2 cos) - 1) in series, which is 0 at cos = 1/2 and grows without bound towards the
// rim. Forces so change continuously while the tool slides over the mesh.

namespace palpate::haptics {
namespace {

using namespace collision;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t max_slots = 1024;  // triangles looked at around the tool's way

// How a sphere that moves along `axis` meets a vertex `lateral` off the axis through its centre.
struct FootprintVertex {
    Vector3d normal;
    double cosine;
};

FootprintVertex meet(const Vector3d& lateral, const Vector3d& axis, double radius) noexcept {
    const double height = std::sqrt(radius * radius - lateral.squaredNorm());
    return {(height * axis - lateral) / radius, height / radius};
}

}  // namespace

std::size_t DeformableContact::collect(const CollisionSurface& surface, const GodObject& god_object,
                                       const Vector3d& goal, const Vector3d& device,
                                       std::span<Contact> points, std::uint32_t& status) const noexcept {
    const double r = god_object.radius();
    std::size_t count = 0;
    const auto add = [&](Contact contact, const Vector3d& point, const Vector3d& normal) {
        if (!(r + normal.dot(point - goal) > 0)) return;
        contact.body = body_index_;
        Eigen::Map<Vector3f>(contact.normal.data()) = normal.cast<float>();
        contact.gap = static_cast<float>(r + normal.dot(point - device));
        if (count < points.size()) {
            points[count++] = contact;
            return;
        }
        status |= contacts_cut;
        if (points.empty()) return;
        Contact& shallowest = *std::ranges::min_element(points, {}, &Contact::gap);
        if (shallowest.gap < contact.gap) shallowest = contact;
    };

    for (const GodObject::Touch& touch : god_object.touches())
        add(point_on(touch.foot), touch.foot.point, touch.normal);

    const Vector3d& p = god_object.position();
    const double depth = (p - goal).norm();
    if (!(depth > 0)) return count;
    const Vector3d axis = (p - goal) / depth;
    std::array<std::int32_t, max_slots> slots;
    std::size_t found = surface.slots_near(goal, p, r, slots);
    if (found > slots.size()) status |= contacts_cut;
    found = std::min(found, slots.size());
    for (std::size_t s = 0; s < found; ++s)
        for (const std::int32_t v : triangles_[surface.mesh_triangle(slots[s])]) {
            const auto vertex = static_cast<std::size_t>(v);
            if (blocks_[vertex] < 0) continue;
            const Vector3d offset = vertices_[vertex].cast<double>() - goal;
            const double height = offset.dot(axis);
            const Vector3d lateral = offset - height * axis;
            if (lateral.squaredNorm() >= r * r || height > depth) continue;
            if (vertex_normals_[vertex].cast<double>().dot(axis) <= 0) continue;
            const auto seen = [&](const Contact& c) { return c.triangle < 0 && c.vertices[0] == v; };
            if (std::any_of(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count), seen))
                continue;
            Contact contact;
            contact.triangle = -1;
            contact.vertices = {v, -1, -1};
            contact.weights = {1, 0, 0};
            const FootprintVertex met = meet(lateral, axis, r);
            // Tissue that faces away from the tool there would be pulled.
            if (vertex_normals_[vertex].cast<double>().dot(met.normal) <= 0) continue;
            if (met.cosine < 0.5) {
                const double own = compliance_between(contact, met.normal, contact, met.normal);
                contact.series_compliance = static_cast<float>(own * (0.5 / std::max(1e-6, met.cosine) - 1));
            }
            add(contact, goal + offset, met.normal);
        }
    return count;
}

Contact DeformableContact::point_on(const ClosestPoint& foot) const noexcept {
    Contact contact;
    contact.body = body_index_;
    contact.triangle = foot.triangle;
    contact.vertices = triangles_[foot.triangle];
    Eigen::Map<Vector3f>(contact.weights.data()) = foot.barycentric.cast<float>();
    return contact;
}

// sum_ij w_ai w_bj C_ij; fixed vertices give nothing.
Matrix3d DeformableContact::block_between(const Contact& a, const Contact& b) const noexcept {
    Matrix3d sum = Matrix3d::Zero();
    for (std::size_t i = 0; i < 3 && a.vertices[i] >= 0; ++i) {
        const std::int32_t block_i = blocks_[a.vertices[i]];
        if (block_i < 0) continue;
        for (std::size_t j = 0; j < 3 && b.vertices[j] >= 0; ++j) {
            const std::int32_t block_j = blocks_[b.vertices[j]];
            if (block_j < 0) continue;
            sum += static_cast<double>(a.weights[i] * b.weights[j]) *
                   compliance_block(compliance_, block_i, block_j).cast<double>();
        }
    }
    return sum;
}

double DeformableContact::compliance_between(const Contact& a, const Vector3d& along_a, const Contact& b,
                                             const Vector3d& along_b) const noexcept {
    // Most points are vertices, and C is stored in float32: no need for more on the way.
    if (a.vertices[1] < 0 && b.vertices[1] < 0 && a.vertices[0] >= 0 && b.vertices[0] >= 0) {
        const std::int32_t block_a = blocks_[a.vertices[0]];
        const std::int32_t block_b = blocks_[b.vertices[0]];
        if (block_a < 0 || block_b < 0) return 0;
        const Vector3f moved = compliance_block(compliance_, block_a, block_b) * along_b.cast<float>();
        return static_cast<double>(a.weights[0] * b.weights[0] * along_a.cast<float>().dot(moved));
    }
    return along_a.dot(block_between(a, b) * along_b);
}

Vector3d DeformableContact::displacement_at(const Contact& point,
                                            std::span<const Contact> contacts) const noexcept {
    Vector3d displacement = Vector3d::Zero();
    for (const Contact& contact : contacts)
        if (contact.body == body_index_ && contact.force > 0)
            displacement -= block_between(point, contact) * force_on_tool(contact);
    return displacement;
}

void DeformableContact::surface_displacement(std::span<const Contact> contacts,
                                             std::span<Vector3f> displacements) const noexcept {
    std::array<NodeForce, 3 * max_contacts> forces;
    std::size_t count = 0;
    for (const Contact& contact : contacts) {
        if (contact.body != body_index_ || !(contact.force > 0)) continue;
        const Vector3f push = -force_on_tool(contact).cast<float>();
        for (std::size_t i = 0; i < 3 && contact.vertices[i] >= 0; ++i)
            if (const std::int32_t block = blocks_[contact.vertices[i]]; block >= 0 && count < forces.size())
                forces[count++] = {block, contact.weights[i] * push};
    }
    std::ranges::fill(displacements, Vector3f::Zero());
    const auto contact_nodes = static_cast<std::size_t>(node_count(compliance_));
    add_displacements(compliance_, std::span(forces).first(count), displacements.first(contact_nodes));
    // Contact nodes are surface vertices in the same order, so that each goes up to its vertex in place.
    for (std::size_t v = displacements.size(); v-- > 0;)
        displacements[v] = blocks_[v] >= 0 ? displacements[blocks_[v]] : Vector3f::Zero();
}

}  // namespace palpate::haptics
