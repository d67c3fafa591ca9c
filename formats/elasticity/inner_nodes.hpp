// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::elasticity {

/// How the inside of a body goes with its surface: no force acts within, so that displacements u_s of all of
/// the boundary leave K_ii u_i = -K_is u_s. Of a surface that forces displace, u_i is what K u = f has there.
/// Source: static condensation (Guyan, AIAA J. 3:380, 1965), read backwards. For one thread.
class InnerNodes {
  public:
    /// Assembles the stiffness. Throws InvalidInput as discretise() and require_sound_materials() do.
    explicit InnerNodes(const DeformableBody& body);

    /// Returns the displacement of every mesh node, mm, from that of every vertex of the boundary's surface,
    /// mm. Middle nodes of a quadratic body's boundary are taken halfway between those of their ends.
    /// Conjugate gradients from where the last call ended, to 1e-6 of the residual or most_steps. Unchecked:
    /// the number of vertices.
    std::vector<Eigen::Vector3f> follow(std::span<const Eigen::Vector3f> surface);

    /// Far beyond what tissue takes whose Poisson's ratio is up to 0.499.
    static constexpr int most_steps = 2000;

  private:
    struct Within;
    std::vector<std::array<std::int32_t, 2>> boundary_edges_;  // surface vertices; empty if linear
    std::vector<std::int32_t> positions_;  // of a mesh node among those within; behind them on the boundary
    std::shared_ptr<Within> within_;
};

}  // namespace palpate::elasticity
