// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/haptics/contact/creep.hpp"
#include "runtime/haptics/contact/inner_balls.hpp"
#include "runtime/haptics/contact/load_spread.hpp"

namespace palpate::haptics {

/// A force on a surface vertex, before it is spread, N.
struct SurfaceForce {
    std::int32_t vertex = 0;
    Eigen::Vector3f force{0, 0, 0};
};

/// A deformable body's side of contact: its surface at rest, and how that gives way on its condensed
/// compliance.
class DeformableContact {
  public:
    /// `surface` is the body's, `tool_radius` (mm) that of all tools; `body_index` goes into the contacts.
    /// Throws InvalidInput if compliance and surface do not belong together.
    DeformableContact(const DeformableBody& body, const collision::CollisionSurface& surface,
                      double tool_radius, std::int32_t body_index, bool spreads_load);

    /// See HapticModel::surface_displacement(); contacts between other bodies are ignored. Thread-safe.
    void surface_displacement(std::span<const Contact> contacts,
                              std::span<Eigen::Vector3f> displacements) const noexcept;
    /// The same under forces on surface vertices.
    void displace(std::span<const SurfaceForce> forces,
                  std::span<Eigen::Vector3f> displacements) const noexcept;
    /// Calls `take` with each vertex that forces go to once they are spread, and its share (N); a vertex may
    /// come several times.
    template <typename Take>
    void each_load(std::span<const SurfaceForce> forces, const Take& take) const noexcept {
        for (const SurfaceForce& of : forces) {
            if (!spread_) {
                take(of.vertex, of.force);
                continue;
            }
            for (const LoadSpread::Share& share : spread_->shares(of.vertex))
                take(share.vertex, Eigen::Vector3f(share.weight * of.force));
        }
    }
    /// Appends the forces of contacts that press this body, or with which it presses another.
    template <typename Forces>
    void append_forces(std::span<const Contact> contacts, Forces& forces) const noexcept {
        for (const Contact& contact : contacts) {
            if (!(contact.force > 0)) continue;
            const Eigen::Vector3f push = -reaction_of(contact).cast<float>();
            if (contact.other_body == body_index_) forces.push_back({contact.other_vertex, -push});
            if (contact.body != body_index_) continue;
            for (std::size_t i = 0; i < 3 && contact.vertices[i] >= 0; ++i)
                forces.push_back({contact.vertices[i], Eigen::Vector3f(contact.weights[i] * push)});
        }
    }
    /// Writes the mean of a field of the surface's vertices as contact feels it at each.
    void average(std::span<const Eigen::Vector3f> field, std::span<Eigen::Vector3f> means) const noexcept;

    std::int32_t body_index() const noexcept { return body_index_; }
    /// How it spreads loads; null if it does not.
    const LoadSpread* spread() const noexcept { return spread_ ? &*spread_ : nullptr; }

    /// Its surface at rest: triangles, the three across the edges of each, vertices (p_P, mm).
    std::size_t triangle_count() const noexcept { return triangles_.size(); }
    const Triangle& triangle(std::int32_t t) const noexcept { return triangles_[t]; }
    const std::array<std::int32_t, 3>& neighbours(std::int32_t t) const noexcept { return neighbours_[t]; }
    std::size_t vertex_count() const noexcept { return vertices_.size(); }
    Eigen::Vector3d rest_position(std::int32_t vertex) const noexcept {
        return vertices_[vertex].cast<double>();
    }
    /// The ball inside the surface at a vertex, which goes with it; of a body that spreads loads.
    const InnerBall& inner_ball(std::int32_t vertex) const noexcept {
        return inner_balls_[static_cast<std::size_t>(vertex)];
    }
    /// How far round edges lie below a point of the surface, mm; 0 of a body that does not spread loads.
    double cut_off(const collision::ClosestPoint& foot) const noexcept {
        double depth = 0;
        for (std::size_t i = 0; i < 3 && !inner_balls_.empty(); ++i)
            depth += foot.barycentric[static_cast<Eigen::Index>(i)] *
                     inner_ball(triangle(foot.triangle)[i]).cut_off();
        return depth;
    }
    /// Whether a vertex gives way at all: it is neither fixed nor left out.
    bool gives_way(std::int32_t vertex) const noexcept { return blocks_[vertex] >= 0; }
    /// How vertex a gives way per force on vertex b, mm/N; zero if either is fixed or left out.
    /// Realtime-safe.
    Eigen::Matrix3f compliance_between(std::int32_t a, std::int32_t b) const noexcept;

    /// How a vertex creeps in ticks of 1 ms; null if it does not. The same for vertices that creep alike.
    const TickCreep* creep_of(std::int32_t vertex) const noexcept {
        return creeps() && creep_of_vertex_[vertex] >= 0 ? &creep_[creep_of_vertex_[vertex]] : nullptr;
    }
    bool creeps() const noexcept { return !creep_.empty(); }
    /// Ticks after which nothing is left of a load; 0 if nothing creeps.
    std::int64_t memory_ticks() const noexcept;

  private:
    std::int32_t body_index_;
    SurfaceCompliance compliance_;
    std::optional<LoadSpread> spread_;
    std::vector<std::int32_t>
        blocks_;  // compliance block of each surface vertex, -1 for one fixed or left out
    std::vector<Triangle> triangles_;  // surface vertices
    std::vector<std::array<std::int32_t, 3>> neighbours_;
    std::vector<Eigen::Vector3f> vertices_;  // at rest, p_P, mm
    std::vector<InnerBall> inner_balls_;     // by vertex
    std::vector<TickCreep> creep_;
    std::vector<std::int32_t> creep_of_vertex_;  // -1 where it does not creep
};

}  // namespace palpate::haptics
