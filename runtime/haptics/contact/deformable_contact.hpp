// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/collision/collision_surface.hpp"
#include "runtime/haptics/contact/god_object.hpp"

namespace palpate::haptics {

/// A deformable body's side of contact: which of its points are in a tool's way, and how they give way on its
/// condensed compliance. The derivation stands above the code, in deformable_contact.cpp.
class DeformableContact {
  public:
    /// `body_index` goes into the contacts. Throws InvalidInput if compliance and surface do not belong
    /// together.
    DeformableContact(const DeformableBody& body, std::int32_t body_index);

    /// Writes the points in the way of a spherical tool to `points` and returns how many; the shallowest are
    /// left out if they are too many (contacts_cut). The god-object lies on the rest surface and was last
    /// moved to `goal`; `device` is where the coupling pulls the tool, which may differ from the goal by how
    /// far other contacts have moved the surface; all mm. Realtime-safe.
    std::size_t collect(const collision::CollisionSurface& surface, const GodObject& god_object,
                        const Eigen::Vector3d& goal, const Eigen::Vector3d& device, std::span<Contact> points,
                        std::uint32_t& status) const noexcept;

    /// sum_ij w_ai w_bj n_a . C_ij n_b: how far point a gives way along -n_a for a unit force at b, mm/N.
    /// Realtime-safe.
    double compliance_between(const Contact& a, const Eigen::Vector3d& along_a, const Contact& b,
                              const Eigen::Vector3d& along_b) const noexcept;

    /// The displacement (mm) of one point under contacts; those of other bodies are ignored. Realtime-safe.
    Eigen::Vector3d displacement_at(const Contact& point, std::span<const Contact> contacts) const noexcept;

    /// See HapticModel::surface_displacement(); contacts of other bodies are ignored. Thread-safe.
    void surface_displacement(std::span<const Contact> contacts,
                              std::span<Eigen::Vector3f> displacements) const noexcept;

    /// A surface point as a contact without force: vertices and weights.
    Contact point_on(const collision::ClosestPoint& foot) const noexcept;

    std::int32_t body_index() const noexcept { return body_index_; }

  private:
    Eigen::Matrix3d block_between(const Contact& a, const Contact& b) const noexcept;

    std::int32_t body_index_;
    SurfaceCompliance compliance_;
    std::vector<std::int32_t>
        blocks_;  // compliance block of each surface vertex, -1 for one fixed or left out
    std::vector<Triangle> triangles_;              // surface vertices
    std::vector<Eigen::Vector3f> vertices_;        // at rest, p_P, mm
    std::vector<Eigen::Vector3f> vertex_normals_;  // area-weighted
};

}  // namespace palpate::haptics
