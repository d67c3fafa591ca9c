// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/published_contact.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace palpate {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::Vector3f;

std::vector<std::int32_t> blocks_of_vertices(const DeformableBody& body) {
    std::vector<std::int32_t> blocks;
    for (const std::int32_t node : body.boundary.nodes) {
        const auto found = std::ranges::lower_bound(body.contact_nodes, node);
        const bool free = found != body.contact_nodes.end() && *found == node;
        blocks.push_back(free ? static_cast<std::int32_t>(found - body.contact_nodes.begin()) : -1);
    }
    return blocks;
}

}  // namespace

std::array<Vector3d, 3> impose_displacement(const SurfaceCompliance& compliance,
                                            const std::array<std::int32_t, 3>& blocks,
                                            const Vector3d& displacement) noexcept {
    std::array<std::size_t, 3> free{};
    Index count = 0;
    for (std::size_t vertex = 0; vertex < 3; ++vertex)
        if (blocks[vertex] >= 0) free[static_cast<std::size_t>(count++)] = vertex;
    std::array<Vector3d, 3> forces{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
    if (count == 0) return forces;

    // Of at most nine rows, so that Eigen allocates nothing.
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 9, 9> C(3 * count, 3 * count);
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 9, 1> u(3 * count), f(3 * count);
    const auto block = [&](Index i) { return blocks[free[static_cast<std::size_t>(i)]]; };
    for (Index i = 0; i < count; ++i) {
        u.segment<3>(3 * i) = displacement;
        for (Index j = 0; j < count; ++j)
            C.block<3, 3>(3 * i, 3 * j) = compliance_block(compliance, block(i), block(j)).cast<double>();
    }
    f = C.ldlt().solve(u);
    for (Index i = 0; i < count; ++i) forces[free[static_cast<std::size_t>(i)]] = f.segment<3>(3 * i);
    return forces;
}

PublishedContact::PublishedContact(const Case& patient_case,
                                   std::span<const std::unique_ptr<CollisionSurface>> surfaces,
                                   ContactScheme scheme)
    : surfaces_(surfaces),
      twice_(scheme == ContactScheme::twice),
      detections_(std::vector<Detection>(surfaces.size())),
      contacted_(surfaces.size()) {
    for (const RigidBody& body : patient_case.rigid_bodies) triangles_.push_back(body.surface.triangles);
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        triangles_.push_back(body.boundary.surface.triangles);
        elastic_.push_back({body.compliance, blocks_of_vertices(body)});
    }
}

void PublishedContact::reset() noexcept {
    device_.write(std::nullopt);
    std::ranges::fill(detections_.back(), Detection{});
    detections_.publish();
    std::ranges::fill(contacted_, Contacted{});
    last_device_.reset();
}

PublishedContact::Detection PublishedContact::inside_or_outside(std::size_t body,
                                                                const Vector3d& p) const noexcept {
    const CollisionSurface& surface = *surfaces_[body];
    const auto nearest = surface.closest_point(p, std::numeric_limits<double>::max());
    if (!nearest) return {};
    const TriangleCorners t = surface.corners(nearest->slot);
    const Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    return {surface.is_outside(p) ? 1 : -1,
            {nearest->point, normal, nearest->barycentric, nearest->triangle}};
}

void PublishedContact::detect() noexcept {
    const Position& position = device_.read();
    if (!position) return;
    const Eigen::Map<const Vector3d> device(position->data());
    std::vector<Detection>& detections = detections_.back();
    for (std::size_t body = 0; body < surfaces_.size(); ++body)
        detections[body] = inside_or_outside(body, device);
    detections_.publish();
}

// The published loop, line by line.
void PublishedContact::decide(std::size_t body, const Detection& detection, bool fresh,
                              const Vector3d& device) noexcept {
    auto& [render_force, foot] = contacted_[body];
    if (fresh) foot = detection.foot;
    if (!twice_) {
        render_force = detection.inside_or_outside == -1;
        return;
    }
    const Vector3d step = last_device_ ? device - *last_device_ : Vector3d::Zero().eval();
    if (detection.inside_or_outside == -1) {
        render_force = true;
    } else if (step.dot(detection.foot.normal) < 0) {
        const Detection second = inside_or_outside(body, *last_device_);
        if (second.inside_or_outside == -1) {
            if (!render_force) foot = second.foot;
            render_force = true;
        }
    } else {
        render_force = false;
    }
    if ((foot.anchor - device).dot(foot.normal) < 0) render_force = false;
}

// The force of a body whose surface is `offset` (mm) from the device. Fills what the contact says of it.
Vector3d PublishedContact::answer(std::size_t body, const Vector3d& offset, double coupling_stiffness,
                                  Contact& contact) const noexcept {
    const Foot& foot = contacted_[body].foot;
    const double depth = offset.dot(foot.normal);
    contact.body = static_cast<std::int32_t>(body);
    contact.triangle = foot.triangle;
    contact.vertices = triangles_[body][static_cast<std::size_t>(foot.triangle)];
    contact.gap = static_cast<float>(depth);
    contact.series_compliance = static_cast<float>(1 / coupling_stiffness);
    Eigen::Map<Vector3f>(contact.weights.data()) = foot.barycentric.cast<float>();
    const std::size_t rigid_count = surfaces_.size() - elastic_.size();
    if (body < rigid_count) return coupling_stiffness * offset;

    const Elastic& elastic = elastic_[body - rigid_count];
    std::array<std::int32_t, 3> blocks{};
    std::ranges::transform(contact.vertices, blocks.begin(),
                           [&](std::int32_t v) { return elastic.blocks[static_cast<std::size_t>(v)]; });
    const auto free = std::ranges::count_if(blocks, [](std::int32_t block) { return block >= 0; });
    if (free == 0) return coupling_stiffness * depth * foot.normal;
    for (std::size_t vertex = 0; vertex < 3; ++vertex)
        contact.weights[vertex] = blocks[vertex] >= 0 ? 1 / static_cast<float>(free) : 0;
    contact.series_compliance = 0;
    const auto [f_P, f_Q, f_R] = impose_displacement(elastic.compliance, blocks, -depth * foot.normal);
    return -(f_P + f_Q + f_R);
}

Vector3d PublishedContact::tick(const Vector3d& device, double coupling_stiffness,
                                TickResult& result) noexcept {
    device_.write(std::array{device[0], device[1], device[2]});
    const bool fresh = detections_.refresh();
    Vector3d sum = Vector3d::Zero();
    for (std::size_t body = 0; body < surfaces_.size(); ++body) {
        decide(body, detections_.front()[body], fresh, device);
        if (!contacted_[body].render_force) continue;
        Contact contact;
        const Vector3d force =
            answer(body, contacted_[body].foot.anchor - device, coupling_stiffness, contact);
        sum += force;
        const double magnitude = force.norm(), depth = contact.gap;
        if (depth > result.depth) {
            result.depth = depth;
            result.body = contact.body;
        }
        if (!(magnitude > 0)) continue;
        if (static_cast<std::size_t>(result.contact_count) == max_contacts) {
            result.status |= contacts_cut;
            continue;
        }
        Eigen::Map<Vector3f>(contact.normal.data()) = (force / magnitude).cast<float>();
        contact.force = static_cast<float>(magnitude);
        result.contacts[static_cast<std::size_t>(result.contact_count++)] = contact;
    }
    last_device_ = device;
    return sum;
}

}  // namespace palpate
