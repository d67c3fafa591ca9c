// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/hyperelasticity/equilibrium.hpp"
#include "formats/model/body.hpp"
#include "runtime/haptics/contact/deformable_contact.hpp"
#include "runtime/haptics/contact/large_shape.hpp"

namespace palpate::haptics {

/// A deformable body as neo-Hookean tissue, solved beside the tick. For one thread; allocates on construction
/// only.
class LargeTissue {
  public:
    /// `contact` must outlive this. Throws as hyperelasticity::Equilibrium.
    LargeTissue(const DeformableBody& body, const DeformableContact& contact);

    void reset() noexcept;

    /// Takes in these forces, goes two steps on from its last shape towards its rest under what it took in,
    /// and writes where it has come. Without any force it is at rest.
    void follow(std::span<const SurfaceForce> forces, LargeShape& shape) noexcept;

  private:
    void take(std::span<const SurfaceForce> forces) noexcept;

    hyperelasticity::Equilibrium equilibrium_;
    const DeformableContact& contact_;
    std::vector<std::int32_t> places_;  // of each surface vertex among the free nodes, -1: fixed
    // N, by free node: the forces that it rests under, by how much those of the tick differ, and did before.
    Eigen::VectorXd loads_, changes_, last_changes_;
    double taken_ = 0;                                // of the difference
    std::vector<Eigen::Vector3f> linear_, answered_;  // mm, by surface vertex: C loads
};

}  // namespace palpate::haptics
