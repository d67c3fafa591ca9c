// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/fem/analytic/error_norms.hpp"

#include <Eigen/LU>

namespace palpate::test {
namespace {

struct QuadraturePoint {
    Eigen::Vector4d barycentric;
    double weight;  // of the volume
};

// 14 points, exact to degree 5: Walkington, "Quadrature on simplices of arbitrary dimension" (2000).
std::vector<QuadraturePoint> degree_five_rule() {
    std::vector<QuadraturePoint> rule;
    for (const auto& [a, weight] : {std::pair{0.31088591926330060980, 6 * 0.018781320953002641800},
                                    std::pair{0.092735250310891226402, 6 * 0.012248840519393658257}})
        for (int i = 0; i < 4; ++i) {
            Eigen::Vector4d point = Eigen::Vector4d::Constant(a);
            point[i] = 1 - 3 * a;
            rule.push_back({point, weight});
        }
    const double a = 0.045503704125649649492;
    for (int i = 0; i < 4; ++i)
        for (int j = i + 1; j < 4; ++j) {
            Eigen::Vector4d point = Eigen::Vector4d::Constant(0.5 - a);
            point[i] = point[j] = a;
            rule.push_back({point, 6 * 0.0070910034628469110730});
        }
    return rule;
}

// Values and gradients (1/mm) of an element's shape functions; corner_gradients are those of the barycentric
// coordinates, as columns.
struct Shapes {
    Eigen::VectorXd values;
    Eigen::Matrix3Xd gradients;
};

Shapes shapes_at(const Eigen::Vector4d& l, const Eigen::Matrix<double, 3, 4>& corner_gradients, int nodes) {
    if (nodes == 4) return {l, corner_gradients};
    constexpr std::array<std::array<int, 2>, 6> edges{{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};
    Shapes shapes{Eigen::VectorXd(10), Eigen::Matrix3Xd(3, 10)};
    for (int i = 0; i < 4; ++i) {
        shapes.values[i] = l[i] * (2 * l[i] - 1);
        shapes.gradients.col(i) = (4 * l[i] - 1) * corner_gradients.col(i);
    }
    for (int e = 0; e < 6; ++e) {
        const auto [i, j] = edges[static_cast<std::size_t>(e)];
        shapes.values[4 + e] = 4 * l[i] * l[j];
        shapes.gradients.col(4 + e) = 4 * (l[i] * corner_gradients.col(j) + l[j] * corner_gradients.col(i));
    }
    return shapes;
}

// lambda tr(e)² + 2 mu e : e of a displacement gradient, N/mm².
double energy_density(const Eigen::Matrix3d& gradient, const Material& m) {
    const Eigen::Matrix3d strain = (gradient + gradient.transpose()) / 2;
    const double lambda =
        m.youngs_modulus * m.poissons_ratio / ((1 + m.poissons_ratio) * (1 - 2 * m.poissons_ratio));
    const double mu = m.youngs_modulus / (2 * (1 + m.poissons_ratio));
    return lambda * strain.trace() * strain.trace() + 2 * mu * strain.squaredNorm();
}

}  // namespace

RelativeErrors errors_against(const ElasticSystem& system, const Eigen::VectorXd& displacements,
                              const ExactField& field) {
    const auto rule = degree_five_rule();
    const Material& material = system.body.materials.front().material;
    const int nodes = system.discretisation.nodes_per_element;
    double displacement_error = 0, energy_error = 0, displacement_norm = 0, energy_norm = 0;
    for (std::size_t t = 0; t < system.body.mesh.tetrahedra.size(); ++t) {
        Eigen::Matrix4d corners;  // rows: 1, x, y, z
        for (int c = 0; c < 4; ++c) {
            corners(0, c) = 1;
            corners.col(c).tail<3>() = system.body.mesh.rest_positions[static_cast<std::size_t>(
                system.body.mesh.tetrahedra[t][static_cast<std::size_t>(c)])];
        }
        const Eigen::Matrix<double, 3, 4> corner_gradients = corners.inverse().rightCols<3>().transpose();
        Eigen::Matrix3Xd u(3, nodes);
        for (int a = 0; a < nodes; ++a)
            u.col(a) = displacements.segment<3>(
                3 * system.discretisation
                        .elements[static_cast<std::size_t>(nodes) * t + static_cast<std::size_t>(a)]);
        for (const auto& [barycentric, share] : rule) {
            const Shapes shapes = shapes_at(barycentric, corner_gradients, nodes);
            const Eigen::Vector3d x = (corners * barycentric).tail<3>();
            const double weight = share * six_volume(system.body.mesh, t) / 6;
            const Eigen::Vector3d exact = field.displacement(x);
            const Eigen::Matrix3d gradient = field.gradient(x);
            displacement_error += weight * (u * shapes.values - exact).squaredNorm();
            displacement_norm += weight * exact.squaredNorm();
            energy_error += weight * energy_density(u * shapes.gradients.transpose() - gradient, material);
            energy_norm += weight * energy_density(gradient, material);
        }
    }
    return {std::sqrt(displacement_error / displacement_norm), std::sqrt(energy_error / energy_norm)};
}

double order_of(double coarse_error, double fine_error, double refinement) {
    return std::log(coarse_error / fine_error) / std::log(refinement);
}

}  // namespace palpate::test
