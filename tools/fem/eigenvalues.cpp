// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/eigenvalues.hpp"

namespace palpate {

double largest_eigenvalue(Eigen::Index size, const std::function<void(Eigen::VectorXd&)>& apply) {
    constexpr int steps = 60;
    // A start without symmetry, so that it is orthogonal to no eigenvector of a symmetric body.
    Eigen::VectorXd v(size);
    for (Eigen::Index i = 0; i < size; ++i) v[i] = 1.0 + 0.5 * static_cast<double>((i * 7919) % 101) / 101.0;
    double eigenvalue = 0;
    for (int step = 0; step < steps; ++step) {
        v.normalize();
        const Eigen::VectorXd before = v;
        apply(v);
        eigenvalue = before.dot(v);
    }
    return eigenvalue;
}

}  // namespace palpate
