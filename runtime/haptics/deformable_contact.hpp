// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/collision/collision_surface.hpp"
#include "runtime/haptics/contact_lcp.hpp"
#include "runtime/haptics/god_object.hpp"
#include "runtime/haptics/tick_result.hpp"

namespace palpate {

/// Exact frictionless contact of a spherical tool with one deformable body, on its condensed compliance. The
/// derivation stands above the code, in deformable_contact.cpp.
class DeformableContact {
  public:
    /// `body_index` goes into the contacts. Throws InvalidInput if compliance and surface do not belong
    /// together.
    DeformableContact(const DeformableBody& body, std::int32_t body_index, const HapticSettings& settings);

    /// What a solve found.
    struct Outcome {
        Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< on the device, N
        double residual = 0;                              ///< worst violation of the contact conditions, mm
        std::uint32_t status = tick_ok;
    };

    /// Finds contact points and forces with the tool's centre at `device` (mm), given the god-object on the
    /// rest surface, and appends them to `contacts` from `contact_count` on. One thread; realtime-safe.
    Outcome solve(const CollisionSurface& surface, const GodObject& god_object, const Eigen::Vector3d& device,
                  std::array<Contact, max_contacts>& contacts, std::int32_t& contact_count) noexcept;

    /// See HapticModel::surface_displacement(); contacts of other bodies are ignored. Thread-safe.
    void surface_displacement(std::span<const Contact> contacts,
                              std::span<Eigen::Vector3f> displacements) const noexcept;

    std::size_t vertex_count() const noexcept { return blocks_.size(); }

  private:
    std::size_t collect(const CollisionSurface& surface, const GodObject& god_object,
                        const Eigen::Vector3d& device, std::span<Contact> points,
                        std::uint32_t& status) noexcept;
    double compliance_between(const Contact& a, const Contact& b) const noexcept;

    std::int32_t body_index_;
    double tool_radius_;
    double coupling_compliance_;  // mm/N
    SurfaceCompliance compliance_;
    std::vector<std::int32_t>
        blocks_;  // compliance block of each surface vertex, -1 for one fixed or left out
    std::vector<Triangle> triangles_;              // surface vertices
    std::vector<Eigen::Vector3f> vertices_;        // at rest, p_P, mm
    std::vector<Eigen::Vector3f> vertex_normals_;  // unit, area-weighted
    ContactLcp lcp_;
    std::array<std::int64_t, max_contacts> last_active_{};  // what the warm start knows contacts by
    std::size_t last_active_count_ = 0;
};

}  // namespace palpate
