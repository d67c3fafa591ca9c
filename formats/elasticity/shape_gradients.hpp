// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "formats/model/tet_mesh.hpp"

namespace palpate::elasticity {

/// Gradients of the barycentric coordinates of a straight-sided tetrahedron, one a column, 1/mm, which are
/// the shape functions of a linear one; and its volume, mm³.
struct TetrahedronShape {
    Eigen::Matrix<double, 3, 4> gradients;
    double volume;
};

/// Of a tetrahedron by its corners, mm. Unchecked: its volume.
TetrahedronShape shape_of(const std::array<Eigen::Vector3d, 4>& corners);

/// The corners of tetrahedron t at rest, p_P, mm.
std::array<Eigen::Vector3d, 4> corners_of(const TetMesh& mesh, std::size_t t);

/// Barycentric coordinates of point q = 0 ... 3 of the quadrature of degree 2, near corner q; all four weigh
/// the same. Source: Hammer & Stroud 1956, also Keast 1986.
Eigen::Vector4d quadrature_point(Eigen::Index q);

/// Gradients of the ten quadratic shape functions at a point given by its barycentric coordinates, one a
/// column, 1/mm: corners N_i = L_i (2 L_i - 1), then the middles of tetrahedron_edges, N_ij = 4 L_i L_j.
/// Source: Zienkiewicz & Taylor, The Finite Element Method, vol. 1.
Eigen::Matrix<double, 3, 10> quadratic_gradients(const Eigen::Matrix<double, 3, 4>& barycentric,
                                                 const Eigen::Vector4d& point);

}  // namespace palpate::elasticity
