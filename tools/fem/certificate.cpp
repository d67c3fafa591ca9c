// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/certificate.hpp"

#include <algorithm>
#include <cblas.h>
#include <lapacke.h>
#include <random>

#include "tools/fem/boundary_conditions.hpp"
#include "tools/fem/eigenvalues.hpp"
#include "tools/fem/sparse_cholesky.hpp"
#include "tools/fem/stiffness.hpp"

namespace palpate {
namespace {

struct SolvedColumns {
    std::vector<Eigen::Index> dofs;  // which columns of C
    Eigen::MatrixXd columns;         // 3m x dofs.size(), mm/N
    std::int64_t free_dofs = 0;
};

// Solves K u = e for randomly chosen contact degrees of freedom, with one step of iterative refinement.
SolvedColumns solve_random_columns(const DeformableBody& body, std::int32_t count, std::uint64_t seed) {
    const Discretisation discretisation = discretise(body);
    const auto position = number_free_nodes(discretisation.node_count, discretisation.fixed_nodes);
    const LowerSparse stiffness = assemble_stiffness(body.mesh, body.materials, discretisation, position);
    const SparseCholesky factor(stiffness, Elimination::fill_reducing);

    const auto m3 = static_cast<Eigen::Index>(3 * body.contact_nodes.size());
    const auto row_of = [&](Eigen::Index dof) {
        const std::int32_t node = body.contact_nodes[static_cast<std::size_t>(dof / 3)];
        return 3 * Eigen::Index{position[static_cast<std::size_t>(node)]} + dof % 3;
    };
    SolvedColumns solved;
    solved.free_dofs = stiffness.rows();
    std::mt19937_64 random(seed);
    for (std::int32_t c = 0; c < count; ++c)
        solved.dofs.push_back(static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(m3)));

    Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(stiffness.rows(), count);
    for (std::int32_t c = 0; c < count; ++c) loads(row_of(solved.dofs[static_cast<std::size_t>(c)]), c) = 1;
    Eigen::MatrixXd u = factor.solve(loads);
    u += factor.solve(loads - stiffness.selfadjointView<Eigen::Lower>() * u);

    solved.columns.resize(m3, count);
    for (Eigen::Index dof = 0; dof < m3; ++dof) solved.columns.row(dof) = u.row(row_of(dof));
    return solved;
}

template <typename Entry>
double worst_residual(const SolvedColumns& solved, const Entry& entry) {
    double worst = 0;
    for (std::size_t c = 0; c < solved.dofs.size(); ++c) {
        const auto column = solved.columns.col(static_cast<Eigen::Index>(c));
        double error = 0;
        for (Eigen::Index i = 0; i < column.size(); ++i)
            error = std::max(error, std::abs(entry(i, solved.dofs[c]) - column[i]));
        worst = std::max(worst, error / column.cwiseAbs().maxCoeff());
    }
    return worst;
}

using StoredMatrix = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

StoredMatrix view_of(const DenseCompliance& compliance) {
    const auto n = static_cast<Eigen::Index>(compliance.dof_count());
    return {compliance.entries.get(), n, n};
}

double asymmetry_of(const StoredMatrix& stored) {
    double difference = 0, largest = 0;
    constexpr Eigen::Index tile = 64;
    for (Eigen::Index i0 = 0; i0 < stored.rows(); i0 += tile)
        for (Eigen::Index j0 = 0; j0 <= i0; j0 += tile) {
            const Eigen::Index h = std::min(tile, stored.rows() - i0), w = std::min(tile, stored.rows() - j0);
            const Eigen::MatrixXf a = stored.block(i0, j0, h, w), b = stored.block(j0, i0, w, h);
            difference = std::max(difference, double{(a - b.transpose()).cwiseAbs().maxCoeff()});
            largest = std::max(largest, double{a.cwiseAbs().maxCoeff()});
        }
    return difference / largest;
}

Eigen::VectorXd apply(const StoredMatrix& stored, const Eigen::VectorXd& load) {
    Eigen::VectorXd u(load.size());
    for (Eigen::Index row = 0; row < load.size(); ++row) u[row] = stored.row(row).cast<double>().dot(load);
    return u;
}

// Maxwell-Betti: the work of load a on b's displacements equals that of b on a's.
double reciprocity_of(const StoredMatrix& stored, std::uint64_t seed) {
    constexpr int pairs = 4;
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const auto load = [&] {
        return Eigen::VectorXd::NullaryExpr(stored.rows(), [&] { return normal(random); });
    };
    double worst = 0;
    for (int pair = 0; pair < pairs; ++pair) {
        const Eigen::VectorXd a = load(), b = load();
        const Eigen::VectorXd u_a = apply(stored, a), u_b = apply(stored, b);
        // Relative to the loads' own energies: a·u_b itself may vanish by chance.
        const double scale = std::sqrt(a.dot(u_a) * b.dot(u_b));
        worst = std::max(worst, std::abs(a.dot(u_b) - b.dot(u_a)) / scale);
    }
    return worst;
}

void certify_stored(const DeformableBody& body, const SolvedColumns& solved, std::uint64_t seed,
                    Certificate& certificate) {
    const StoredMatrix stored = view_of(body.compliance);
    certificate.residual =
        worst_residual(solved, [&](Eigen::Index i, Eigen::Index j) { return double{stored(i, j)}; });
    certificate.asymmetry = asymmetry_of(stored);
    certificate.reciprocity = reciprocity_of(stored, seed);
    certificate.sampled_columns = static_cast<std::int32_t>(solved.dofs.size());
    certificate.free_dofs = solved.free_dofs;
}

}  // namespace

Certificate certify(const DeformableBody& body, const ExactCompliance& exact) {
    Certificate certificate;
    const SolvedColumns solved = solve_random_columns(body, certificate_columns, certificate_seed);
    certificate.residual_double = worst_residual(solved, [&](Eigen::Index i, Eigen::Index j) {
        return i >= j ? exact.lower(i, j) : exact.lower(j, i);
    });
    certify_stored(body, solved, certificate_seed, certificate);
    certificate.smallest_eigenvalue = exact.smallest_eigenvalue;
    certificate.largest_eigenvalue = exact.largest_eigenvalue;
    certificate.condition_number = exact.largest_eigenvalue / exact.smallest_eigenvalue;
    return certificate;
}

Certificate recertify(const DeformableBody& body, std::int32_t columns, std::uint64_t seed) {
    require_no_rigid_motion(body.mesh, body.fixed_nodes);
    Certificate certificate;
    certify_stored(body, solve_random_columns(body, columns, seed), seed, certificate);

    const StoredMatrix stored = view_of(body.compliance);
    const auto n = static_cast<Eigen::Index>(body.compliance.dof_count());
    certificate.largest_eigenvalue = largest_eigenvalue(n, [&](Eigen::VectorXd& v) { v = apply(stored, v); });
    Eigen::MatrixXd factor = stored.cast<double>();
    const auto size = static_cast<lapack_int>(n);
    if (LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', size, factor.data(), size) != 0) return certificate;
    certificate.smallest_eigenvalue =
        1.0 / largest_eigenvalue(n, [&](Eigen::VectorXd& v) {
            LAPACKE_dpotrs(LAPACK_COL_MAJOR, 'L', size, 1, factor.data(), size, v.data(), size);
        });
    certificate.condition_number = certificate.largest_eigenvalue / certificate.smallest_eigenvalue;
    return certificate;
}

}  // namespace palpate
