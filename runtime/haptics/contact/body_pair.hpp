// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/collision/collision_surface.hpp"

// Contact between two deformable bodies, A (0) and B (1), on their condensed compliances, linear about the
// rest configuration. The functions allocate; none belongs into the tick.

namespace palpate::haptics {

/// The surface of a deformable body at rest, with its compliance by surface vertices.
class ElasticSurface {
  public:
    /// Compliance entries are shared, the rest is copied. Throws InvalidInput if surface, tree and compliance
    /// do not belong together. Linear in the surface.
    explicit ElasticSurface(const DeformableBody& body);

    const std::vector<Eigen::Vector3d>& vertices() const noexcept { return surface_.vertices; }  ///< p_P, mm
    const std::vector<Triangle>& triangles() const noexcept { return surface_.triangles; }
    const collision::CollisionSurface& collision() const noexcept { return collision_; }

    /// Tells whether a vertex is a contact node; others are fixed or left out, and count as fixed.
    bool is_free(std::int32_t vertex) const noexcept { return blocks_[vertex] >= 0; }

    /// Tells whether any vertex of a polygon is free.
    bool is_free(const Triangle& polygon) const noexcept;

    /// Displacement of vertex a per force on vertex b, mm/N; zero if one of them is not free. Realtime-safe.
    Eigen::Matrix3d compliance(std::int32_t a, std::int32_t b) const noexcept;

  private:
    TriangleMesh surface_;
    collision::CollisionSurface collision_;
    SurfaceCompliance compliance_;
    std::vector<std::int32_t>
        blocks_;  // compliance block of each surface vertex, -1 for one that is not free
};

using BodyPair = std::array<ElasticSurface, 2>;  ///< A, B

/// A node of one body inside a polygon of the other, or near it.
struct PairContact {
    std::size_t node_body = 0;         ///< 0: node of A, polygon of B; 1: node of B, polygon of A
    std::int32_t node = 0;             ///< X: surface vertex of node_body
    Triangle polygon{};                ///< PQR: surface vertices of the other body
    Eigen::Vector3d weights{0, 0, 0};  ///< F = wP P + wQ Q + wR R, the polygon's point nearest to X
    Eigen::Vector3d normal{0, 0, 0};   ///< n, unit, along the line through F and X, from B to A
    double gap = 0;                    ///< delta, mm: how far A and B must part along n
};

struct VertexForce {
    std::int32_t vertex = 0;         ///< of the surface
    Eigen::Vector3d force{0, 0, 0};  ///< on the body, N
};
using PairForces = std::array<std::vector<VertexForce>, 2>;  ///< on A, on B

/// How two bodies stand under given forces.
struct PairSolution {
    PairForces forces;                                          ///< by ascending vertex
    std::vector<std::array<Eigen::Vector3d, 2>> displacements;  ///< u_A, u_B at each contact, mm
    std::vector<double> distances;  ///< n . (u_A - u_B) - delta at each contact, mm; < 0: still inside
    double energy = 0;              ///< elastic, of both bodies: sum of f.u / 2, N mm
};

/// Finds the nodes of A that lie inside B, and those of B inside A, with B moved by `offset` (mm) from where
/// its vertices say; and, with negative gaps, those that are outside by no more than `margin` >= 0 (mm),
/// which deformation may bring in. A node belongs to the polygon nearest to it; where neither node nor
/// polygon is free there is no contact. Nodes of A come first, by ascending vertex. The surfaces must be
/// closed (unchecked). Cost: two queries per vertex.
std::vector<PairContact> find_contacts(const BodyPair& bodies, const Eigen::Vector3d& offset, double margin);

/// Computes displacements u = C f, distances and energy under given forces.
PairSolution solution_under(const BodyPair& bodies, std::span<const PairContact> contacts, PairForces forces);

/// Solves frictionless contact: the forces f_k >= 0 that push A by f_k n_k and B by -f_k n_k, so that
///     w = A f - delta >= 0,  f . w = 0,   A_kl = sum_ij (w_ki w_lj n_k . C_A,ij n_l) + the same with C_B.
/// Of all displacements that part the bodies at the contacts, these cost the least elastic energy, and
/// forces balance. Any number of contacts of which no more than max_contacts press; where more would, the
/// solution's distances tell. Cost: the matrix, ten blocks of C per entry, and ContactLcp.
PairSolution solve_exactly(const BodyPair& bodies, std::span<const PairContact> contacts);

/// Splits the displacement by the ratio of temporary surface forces, as published (Kuroda et al. 2005; the
/// reference system's paper, section 3):
/// 1. node X of one body is inside polygon PQR of the other, both ways: the contacts with delta > 0;
/// 2. FX is given to P, Q and R as temporary displacement;
/// 3. temporary deformation imposes these on each body (Hirota: C_cc f_c = u_c over all imposed nodes);
/// 4. a polygon's temporary surface force is f = (f_P + f_Q + f_R) / 3;
/// 5. for X of A inside PQR of B, X moves by U_A = -|f_B| / (|f_A| + |f_B|) FX, and P, Q, R by
///    U_B = |f_A| / (|f_A| + |f_B|) FX (eq. 4, 5). Imposing these gives the final forces. Nodes of B inside A
///    serve steps 2 to 4 alone: one body gives its nodes, the other its polygons.
/// Where the paper is silent: a vertex of several polygons moves by the average of what they ask; f_A is that
/// of the colliding polygon of A whose F is nearest to X; where no polygon of A collides, X takes its place
/// in steps 2 to 4; where no node of A is inside B, the bodies change places; what is held stays, and its
/// counterpart goes all the way. Forces need not balance, and may pull. Cost: four Cholesky factors of C_cc.
PairSolution split_by_force_ratio(const BodyPair& bodies, std::span<const PairContact> contacts);

}  // namespace palpate::haptics
