// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/solvers/eigenvalues.hpp"

#include <Spectra/SymEigsSolver.h>
#include <algorithm>

#include "formats/model/errors.hpp"

namespace palpate::fem {
namespace {

struct Map {
    using Scalar = double;
    Eigen::Index size;
    const std::function<void(Eigen::VectorXd&)>& apply;

    Eigen::Index rows() const { return size; }
    Eigen::Index cols() const { return size; }
    void perform_op(const double* in, double* out) const {
        Eigen::VectorXd v = Eigen::Map<const Eigen::VectorXd>(in, size);
        apply(v);
        Eigen::Map<Eigen::VectorXd>(out, size) = v;
    }
};

}  // namespace

double largest_eigenvalue(Eigen::Index size, const std::function<void(Eigen::VectorXd&)>& apply) {
    constexpr Eigen::Index basis = 20, restarts = 100;
    constexpr double tolerance = 1e-2;
    Map map{size, apply};
    Spectra::SymEigsSolver<Map> solver(map, 1, std::min(basis, size));
    solver.init();
    solver.compute(Spectra::SortRule::LargestAlge, restarts, tolerance);
    if (solver.info() != Spectra::CompInfo::Successful)
        throw SystemFailure({"Lanczos iteration", "found no largest eigenvalue", "", "report this mesh"});
    return solver.eigenvalues()[0];
}

}  // namespace palpate::fem
