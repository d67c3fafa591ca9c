// SPDX-License-Identifier: Apache-2.0
// Which vertices may meet the body beside theirs: found before the first tick.
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "runtime/haptics/contact/equilibrium/neighbour_contact.hpp"
#include "runtime/haptics/contact/triangle_neighbours.hpp"

namespace palpate::haptics {
namespace {

using namespace collision;
using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr double ball_radius = 1;      // mm
constexpr double deepest_overlap = 4;  // mm, at rest
constexpr double overlap_step = 0.1;   // mm
// Of a body's least extent: so far it may be pushed, beyond which linear elasticity says little.
constexpr double farthest_push = 0.125;

AlignedBox3d box_of(const CollisionSurface& surface) {
    AlignedBox3d box;
    for (std::int32_t slot = 0; slot < surface.triangle_count(); ++slot)
        for (const Vector3d& corner : surface.corners(slot)) box.extend(corner);
    return box;
}

double mean_edge(const DeformableContact& body) {
    double sum = 0;
    for (std::size_t t = 0; t < body.triangle_count(); ++t) {
        const Triangle& triangle = body.triangle(static_cast<std::int32_t>(t));
        for (std::size_t corner = 0; corner < 3; ++corner)
            sum += (body.rest_position(triangle[corner]) - body.rest_position(triangle[(corner + 1) % 3]))
                       .norm();
    }
    return sum / (3 * static_cast<double>(body.triangle_count()));
}

// Out of the surface, by area; unit, or zero.
std::vector<Vector3d> vertex_normals(const DeformableContact& body) {
    std::vector<Vector3d> normals(body.vertex_count(), Vector3d::Zero());
    for (std::size_t t = 0; t < body.triangle_count(); ++t) {
        const Triangle& triangle = body.triangle(static_cast<std::int32_t>(t));
        const Vector3d a = body.rest_position(triangle[0]), b = body.rest_position(triangle[1]),
                       c = body.rest_position(triangle[2]);
        for (const std::int32_t v : triangle) normals[v] += (b - a).cross(c - a);
    }
    for (Vector3d& normal : normals) normal.normalize();
    return normals;
}

}  // namespace

NeighbourContact::NeighbourContact(const ContactBodies& bodies) : bodies_(bodies) {
    const std::size_t rigid = bodies.rigid_count();
    if (bodies.surfaces.size() < 2) return;
    std::vector<AlignedBox3d> boxes;
    std::vector<double> edges;
    for (const auto& surface : bodies.surfaces) boxes.push_back(box_of(*surface));
    for (const DeformableContact& body : bodies.deformable) edges.push_back(mean_edge(body));
    const auto push = [&](std::size_t body) {
        return body < rigid ? 0 : farthest_push * boxes[body].sizes().minCoeff();
    };
    for (std::size_t soft = 0; soft < bodies.deformable.size(); ++soft)
        for (std::size_t body = 0; body < bodies.surfaces.size(); ++body) {
            if (body == rigid + soft) continue;
            // Of two deformable bodies, the finer gives the vertices.
            if (body >= rigid && (edges[body - rigid] < edges[soft] ||
                                  (edges[body - rigid] == edges[soft] && body < rigid + soft)))
                continue;
            const double reach = push(rigid + soft) + push(body);
            if (boxes[rigid + soft].exteriorDistance(boxes[body]) <= reach)
                add_interface(soft, body, boxes[body], reach);
        }
    forget();
}

void NeighbourContact::add_interface(std::size_t soft, std::size_t body, const AlignedBox3d& box,
                                     double reach) {
    const DeformableContact& owner = bodies_.deformable[soft];
    const CollisionSurface& surface = *bodies_.surfaces[body];
    const std::size_t rigid = bodies_.rigid_count();
    Interface interface;
    interface.soft = static_cast<std::int32_t>(soft);
    interface.body = static_cast<std::int32_t>(body);
    interface.other = body < rigid ? -1 : static_cast<std::int32_t>(body - rigid);
    interface.first = interface.next = probes_.size();
    const std::vector<Vector3d> normals = vertex_normals(owner);
    for (std::size_t v = 0; v < owner.vertex_count(); ++v) {
        Probe probe;
        probe.interface = interfaces_.size();
        probe.vertex = static_cast<std::int32_t>(v);
        const Vector3d vertex = owner.rest_position(probe.vertex);
        if (box.exteriorDistance(vertex) > reach) continue;
        const auto from_vertex = surface.closest_point(vertex, std::numeric_limits<double>::infinity());
        const bool outside = surface.is_outside(vertex, *from_vertex);
        if (outside && from_vertex->distance > reach) continue;
        // What looks away from the other body does not meet it.
        if (outside && from_vertex->distance > ball_radius && normals[v].dot(from_vertex->point - vertex) < 0)
            continue;
        // A ball that touches the vertex from behind, as the other body sees it, or where they overlap at
        // rest, farther behind.
        const Vector3d away = outside && from_vertex->distance > slight_gap
                                  ? Vector3d((vertex - from_vertex->point) / from_vertex->distance)
                                  : surface.pseudonormal(from_vertex->point);
        for (double depth = ball_radius; depth <= ball_radius + deepest_overlap; depth += overlap_step) {
            const Vector3d centre = vertex + depth * away;
            const auto nearest = surface.closest_point(centre, std::numeric_limits<double>::infinity());
            if (nearest->distance < ball_radius + slight_gap || !surface.is_outside(centre, *nearest))
                continue;
            Eigen::Index corner = 0;
            nearest->barycentric.maxCoeff(&corner);
            const Triangle& triangle = bodies_.triangles[body][static_cast<std::size_t>(nearest->triangle)];
            const auto gives_way = [&](std::int32_t other) {
                return interface.other >= 0 && bodies_.deformable[body - rigid].gives_way(other);
            };
            if (!owner.gives_way(probe.vertex) && std::ranges::none_of(triangle, gives_way)) break;
            probe.arm = centre - vertex;
            probe.radius = ball_radius;
            probe.gap_at_rest = nearest->distance - ball_radius;
            probe.at_rest = {nearest->triangle, nearest->slot, triangle[static_cast<std::size_t>(corner)]};
            probes_.push_back(probe);
            break;
        }
    }
    interface.end = probes_.size();
    if (interface.first == interface.end) return;
    if (body < rigid) {
        interface.neighbours = triangle_neighbours(bodies_.triangles[body]);
        interface.tree_slots.resize(bodies_.triangles[body].size());
        for (std::int32_t slot = 0; slot < surface.triangle_count(); ++slot)
            interface.tree_slots[static_cast<std::size_t>(surface.mesh_triangle(slot))] = slot;
    }
    interfaces_.push_back(std::move(interface));
}

}  // namespace palpate::haptics
