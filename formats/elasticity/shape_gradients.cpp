// SPDX-License-Identifier: Apache-2.0
#include "formats/elasticity/shape_gradients.hpp"

#include <Eigen/LU>
#include <cmath>

#include "formats/elasticity/discretisation.hpp"

namespace palpate::elasticity {

TetrahedronShape shape_of(const std::array<Eigen::Vector3d, 4>& p) {
    Eigen::Matrix3d edges;
    edges << p[1] - p[0], p[2] - p[0], p[3] - p[0];
    TetrahedronShape shape;
    shape.gradients.rightCols<3>() = edges.inverse().transpose();
    shape.gradients.col(0) = -shape.gradients.rightCols<3>().rowwise().sum();
    shape.volume = edges.determinant() / 6;
    return shape;
}

std::array<Eigen::Vector3d, 4> corners_of(const TetMesh& mesh, std::size_t t) {
    std::array<Eigen::Vector3d, 4> points;
    for (std::size_t c = 0; c < 4; ++c) points[c] = mesh.rest_positions[mesh.tetrahedra[t][c]];
    return points;
}

Eigen::Vector4d quadrature_point(Eigen::Index q) {
    const double near = (5 + 3 * std::sqrt(5.0)) / 20, far = (5 - std::sqrt(5.0)) / 20;
    Eigen::Vector4d point = Eigen::Vector4d::Constant(far);
    point[q] = near;
    return point;
}

Eigen::Matrix<double, 3, 10> quadratic_gradients(const Eigen::Matrix<double, 3, 4>& barycentric,
                                                 const Eigen::Vector4d& point) {
    Eigen::Matrix<double, 3, 10> gradients;
    for (Eigen::Index i = 0; i < 4; ++i) gradients.col(i) = (4 * point[i] - 1) * barycentric.col(i);
    for (std::size_t e = 0; e < tetrahedron_edges.size(); ++e) {
        const auto i = static_cast<Eigen::Index>(tetrahedron_edges[e][0]),
                   j = static_cast<Eigen::Index>(tetrahedron_edges[e][1]);
        gradients.col(4 + static_cast<Eigen::Index>(e)) =
            4 * (point[j] * barycentric.col(i) + point[i] * barycentric.col(j));
    }
    return gradients;
}

}  // namespace palpate::elasticity
