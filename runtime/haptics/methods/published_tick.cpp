// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "runtime/haptics/methods/published_contact.hpp"

namespace palpate::haptics {

using namespace collision;
using Eigen::Index;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr int stale_ticks = 100;  // three periods of the collision loop

// Fixed in size, so that nothing is allocated.
template <std::size_t count>
void impose(const SurfaceCompliance& compliance, const std::array<std::int32_t, 3>& blocks,
            const std::array<std::size_t, 3>& free, const Vector3d& displacement,
            std::array<Vector3d, 3>& forces) noexcept {
    constexpr auto n = static_cast<int>(3 * count);
    Eigen::Matrix<double, n, n> C;
    Eigen::Matrix<double, n, 1> u;
    for (std::size_t i = 0; i < count; ++i) {
        const auto row = static_cast<Index>(3 * i);
        u.template segment<3>(row) = displacement;
        for (std::size_t j = 0; j < count; ++j)
            C.template block<3, 3>(row, static_cast<Index>(3 * j)) =
                compliance_block(compliance, blocks[free[i]], blocks[free[j]]).template cast<double>();
    }
    const Eigen::Matrix<double, n, 1> f = C.ldlt().solve(u);
    for (std::size_t i = 0; i < count; ++i)
        forces[free[i]] = f.template segment<3>(static_cast<Index>(3 * i));
}

}  // namespace

std::array<Vector3d, 3> impose_displacement(const SurfaceCompliance& compliance,
                                            const std::array<std::int32_t, 3>& blocks,
                                            const Vector3d& displacement) noexcept {
    std::array<std::size_t, 3> free{};
    std::size_t count = 0;
    for (std::size_t vertex = 0; vertex < 3; ++vertex)
        if (blocks[vertex] >= 0) free[count++] = vertex;
    std::array<Vector3d, 3> forces{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
    if (count == 1) impose<1>(compliance, blocks, free, displacement, forces);
    if (count == 2) impose<2>(compliance, blocks, free, displacement, forces);
    if (count == 3) impose<3>(compliance, blocks, free, displacement, forces);
    return forces;
}

PublishedContact::Detection PublishedContact::inside_or_outside(std::size_t body,
                                                                const Vector3d& p) const noexcept {
    const CollisionSurface& surface = *bodies_.surfaces[body];
    const auto nearest = surface.closest_point(p, std::numeric_limits<double>::max());
    if (!nearest) return {};
    return {surface.is_outside(p, *nearest) ? 1 : -1,
            {nearest->point, surface.outward_normal(*nearest), nearest->barycentric, nearest->triangle}};
}

void PublishedContact::lose() noexcept {
    device_.write({.losses = ++losses_});
    detected_ = false;
    ticks_undetected_ = 0;
    std::ranges::fill(contacted_, Contacted{});
    last_device_.reset();
}

void PublishedContact::detect() noexcept {
    answer(asked());
}

void PublishedContact::detect_at(const std::array<double, 3>& device, std::int64_t tick) noexcept {
    answer({.device = device, .tick = tick, .losses = asked().losses, .trusted = true});
}

void PublishedContact::answer(const Asked& asked) noexcept {
    if (!asked.trusted) return;
    Answered& answer = detections_.back();
    for (std::size_t body = 0; body < bodies_.surfaces.size(); ++body)
        answer.bodies[body] = inside_or_outside(body, Eigen::Map<const Vector3d>(asked.device.data()));
    answer.tick = asked.tick;
    answer.losses = asked.losses;
    detections_.publish();
}

// The published loop, line by line.
void PublishedContact::decide(std::size_t body, const Detection& detection, bool fresh,
                              const Vector3d& device) noexcept {
    auto& [render_force, foot] = contacted_[body];
    const bool keeps = !renewed_ && render_force;
    if (fresh && !(keeps && detection.foot.normal.dot(foot.normal) < 0)) foot = detection.foot;
    if (!twice_) {
        render_force = detection.inside_or_outside == -1;
        return;
    }
    const Vector3d step = last_device_ ? device - *last_device_ : Vector3d::Zero().eval();
    if (detection.inside_or_outside == -1) {
        render_force = true;
    } else if (step.dot(keeps ? foot.normal : detection.foot.normal) < 0) {
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
Vector3d PublishedContact::force_of(std::size_t body, const Vector3d& offset, double coupling_stiffness,
                                    Contact& contact) const noexcept {
    const Foot& foot = contacted_[body].foot;
    const double depth = offset.dot(foot.normal);
    contact.body = static_cast<std::int32_t>(body);
    contact.triangle = foot.triangle;
    contact.vertices = bodies_.triangles[body][foot.triangle];
    contact.gap = static_cast<float>(depth);
    contact.series_compliance = static_cast<float>(1 / coupling_stiffness);
    Eigen::Map<Vector3f>(contact.weights.data()) = foot.barycentric.cast<float>();
    const std::size_t rigid_count = bodies_.rigid_count();
    if (body < rigid_count) return coupling_stiffness * offset;

    const Elastic& elastic = elastic_[body - rigid_count];
    std::array<std::int32_t, 3> blocks{};
    std::ranges::transform(contact.vertices, blocks.begin(),
                           [&](std::int32_t v) { return elastic.blocks[v]; });
    const auto free = std::ranges::count_if(blocks, [](std::int32_t block) { return block >= 0; });
    if (free == 0) return coupling_stiffness * depth * foot.normal;
    for (std::size_t vertex = 0; vertex < 3; ++vertex)
        contact.weights[vertex] = blocks[vertex] >= 0 ? 1 / static_cast<float>(free) : 0;
    contact.series_compliance = 0;
    const auto [f_P, f_Q, f_R] = impose_displacement(elastic.compliance, blocks, -depth * foot.normal);
    return -(f_P + f_Q + f_R);
}

void PublishedContact::tick(std::span<const ContactPose> poses, const VirtualCoupling& coupling,
                            std::span<TickResult> results, std::span<Vector3d> forces) noexcept {
    if (poses[0].trusted)
        forces[0] = tick(poses[0].tip, coupling.stiffness, results[0]);
    else
        lose();
}

Vector3d PublishedContact::tick(const Vector3d& device, double coupling_stiffness,
                                TickResult& result) noexcept {
    device_.write({{device[0], device[1], device[2]}, result.tick, losses_, true});
    // An answer that was on its way when the tool was lost says nothing of where it was found again.
    const bool fresh = detections_.refresh() && detections_.front().losses == losses_;
    detected_ = detected_ || fresh;
    if (fresh) result.detected_tick = detections_.front().tick;
    ticks_undetected_ = fresh ? 0 : ticks_undetected_ + 1;
    if (ticks_undetected_ > stale_ticks) result.faults |= collision_stale;
    Vector3d sum = Vector3d::Zero();
    for (std::size_t body = 0; body < bodies_.surfaces.size(); ++body) {
        decide(body, detected_ ? detections_.front().bodies[body] : Detection{}, fresh, device);
        if (!contacted_[body].render_force) continue;
        Contact contact;
        const Vector3d force =
            force_of(body, contacted_[body].foot.anchor - device, coupling_stiffness, contact);
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
        result.contacts[result.contact_count++] = contact;
    }
    last_device_ = device;
    return sum;
}

}  // namespace palpate::haptics
