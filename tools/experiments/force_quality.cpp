// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/force_quality.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/model/arrays.hpp"

namespace palpate::experiments {
namespace {

using Eigen::Vector3d;

constexpr double work_rounding = 1e-9;  // N mm, of sums over a run

}  // namespace

RestNormals::RestNormals(const Case& patient_case) {
    const auto add = [&](const TriangleMesh& mesh) {
        Surface& surface = surfaces_.emplace_back();
        surface.triangles = mesh.triangles;
        surface.triangles_at.resize(mesh.vertices.size());
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            std::array<Vector3d, 3> p;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const auto v = static_cast<std::size_t>(mesh.triangles[t][corner]);
                p[corner] = mesh.vertices[v];
                surface.triangles_at[v].push_back(static_cast<std::int32_t>(t));
            }
            surface.normals.push_back((p[1] - p[0]).cross(p[2] - p[0]).normalized());
        }
    };
    for (const RigidBody& body : patient_case.rigid_bodies) add(body.surface);
    for (const DeformableBody& body : patient_case.deformable_bodies) add(body.boundary.surface);
}

double RestNormals::pull(const Contact& contact) const {
    const Surface& surface = surfaces_[contact.body];
    std::vector<std::int32_t> holding;  // vertices
    for (std::size_t i = 0; i < 3; ++i)
        if (contact.vertices[i] >= 0 && contact.weights[i] > 1e-6F) holding.push_back(contact.vertices[i]);
    const Vector3d force = static_cast<double>(contact.force) * normal_of(contact);
    double least = std::numeric_limits<double>::max();
    for (const std::int32_t t : surface.triangles_at[holding.front()]) {
        const Triangle& triangle = surface.triangles[t];
        const bool holds = std::ranges::all_of(
            holding, [&](std::int32_t v) { return std::ranges::find(triangle, v) != triangle.end(); });
        if (holds) least = std::min(least, -force.dot(normal(static_cast<std::size_t>(contact.body), t)));
    }
    return std::max(0.0, least);
}

const Vector3d& RestNormals::normal(std::size_t body, std::int32_t triangle) const {
    return surfaces_[body].normals[triangle];
}

void ForceFigures::Steps::add(double step) {
    ++count;
    jumps += step > jump_limit * (1 + 1e-9);  // the limiter's own steps are up to the limit
    largest = std::max(largest, step);
    squared_sum += step * step;
}

double ForceFigures::Steps::roughness() const {
    constexpr double rate_hz = 1000;
    return count == 0 ? 0 : rate_hz * std::sqrt(squared_sum / static_cast<double>(count));
}

// Ours records one contact, the resultant, of all walls that hold the tool and do not give way.
double ForceQuality::pull_of(const Contact& contact, const TickResult& result) const {
    constexpr double touching = 1e-3;  // mm, above the god-object's skin
    const bool gives_way =
        static_cast<std::size_t>(contact.body) >= model_.rigid_count() && contact.vertices[0] >= 0;
    if (!model_.method().can.sums_rigid_walls || gives_way || result.contact_count > 1)
        return normals_.pull(contact);
    const Vector3d tool = vector_of(result.tool_position);
    const double reach = model_.settings().tool_radius + touching;
    const Vector3d force = static_cast<double>(contact.force) * normal_of(contact);
    double least = -force.dot(normals_.normal(static_cast<std::size_t>(contact.body), contact.triangle));
    for (std::size_t body = 0; body < model_.body_count(); ++body) {
        const collision::CollisionSurface& surface = model_.surface(body);
        std::vector<std::int32_t> slots(surface.slots_near(tool, tool, reach, {}));
        surface.slots_near(tool, tool, reach, slots);
        for (const std::int32_t slot : slots)
            if (collision::closest_point_on_triangle(tool, surface.corners(slot)).squared_distance <=
                reach * reach)
                least = std::min(least, -force.dot(normals_.normal(body, surface.mesh_triangle(slot))));
    }
    return std::max(0.0, least);
}

void ForceQuality::begin_run() {
    first_ = true;
    in_episode_ = false;
}

void ForceQuality::add(const TickResult& result, const Vector3d& tip) {
    Vector3d sum = Vector3d::Zero();
    double pull = 0;
    for (const Contact& contact : result.active_contacts()) {
        sum += force_on_tool(contact);
        pull = std::max(pull, pull_of(contact, result));
    }
    ++figures_.ticks;
    figures_.touching_ticks += result.contact_count > 0;
    figures_.pulling_ticks += pull > ForceFigures::pull_limit;
    figures_.strongest_pull = std::max(figures_.strongest_pull, pull);

    const Vector3d force = vector_of(result.force);
    if (!first_) {
        figures_.wanted.add((sum - last_wanted_).norm());
        figures_.rendered.add((force - last_force_).norm());
        count_energy(force, tip);
    }
    first_ = false;
    last_wanted_ = sum;
    last_force_ = force;
    last_tip_ = tip;
}

// The last force was held while the tip went to `tip`.
void ForceQuality::count_energy(const Vector3d& force, const Vector3d& tip) {
    const bool felt = !last_force_.isZero(0) || !force.isZero(0);
    if (!felt) {
        in_episode_ = false;
        return;
    }
    if (!in_episode_) {
        in_episode_ = true;
        over_ = false;
        episode_given_ = episode_bound_ = 0;
        ++figures_.episodes;
    }
    const Vector3d way = tip - last_tip_;
    const double length = way.norm(), work = last_force_.dot(way);
    const double allowed = passivity_.stiffness * length * (length / 2 + std::sqrt(3.0) * passivity_.grain);
    figures_.given += work;
    figures_.bound += allowed;
    episode_given_ += work;
    episode_bound_ += allowed;
    const double over = episode_given_ - episode_bound_;
    figures_.most_given = std::max(figures_.most_given, episode_given_);
    figures_.worst_over_bound = std::max(figures_.worst_over_bound, over);
    figures_.over_bound += over > work_rounding && !over_;
    over_ = over_ || over > work_rounding;
}

}  // namespace palpate::experiments
