// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/certificate/certificate.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <lapacke.h>
#include <limits>
#include <random>

#include "tools/fem/assembly/rigid_motions.hpp"
#include "tools/fem/certificate/contact_loads.hpp"
#include "tools/fem/solvers/eigenvalues.hpp"
#include "tools/fem/solvers/free_system.hpp"
#include "tools/fem/solvers/interior_elimination.hpp"

namespace palpate::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Index dof_count(const DeformableBody& body) {
    return static_cast<Index>(3 * body.contact_nodes.size());
}

// Solutions of the body's stiffness by a factorisation that the condensation has no part in.
class Judge {
  public:
    explicit Judge(const DeformableBody& body)
        : system_(assemble_free_system(body, NodeOrder::as_numbered)),
          factor_(factorise(body, system_, Elimination::fill_reducing)) {}

    const FreeSystem& system() const { return system_; }

    // Displacements of the contact nodes under forces on them, both 3m x k.
    MatrixXd displacements(const MatrixXd& forces, bool refine) const {
        MatrixXd loads = MatrixXd::Zero(system_.stiffness.rows(), forces.cols());
        for (std::size_t dof = 0; dof < system_.contact_rows.size(); ++dof)
            loads.row(system_.contact_rows[dof]) = forces.row(static_cast<Index>(dof));
        MatrixXd u = factor_.solve(loads);
        if (refine) u += factor_.solve(loads - system_.stiffness.selfadjointView<Eigen::Lower>() * u);
        MatrixXd surface(forces.rows(), forces.cols());
        for (std::size_t dof = 0; dof < system_.contact_rows.size(); ++dof)
            surface.row(static_cast<Index>(dof)) = u.row(system_.contact_rows[dof]);
        return surface;
    }

    MatrixXd columns(const std::vector<Index>& dofs, Index size) const {
        MatrixXd forces = MatrixXd::Zero(size, static_cast<Index>(dofs.size()));
        for (std::size_t c = 0; c < dofs.size(); ++c) forces(dofs[c], static_cast<Index>(c)) = 1;
        return displacements(forces, true);
    }

  private:
    FreeSystem system_;
    SparseCholesky factor_;
};

using StoredMatrix = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

StoredMatrix view_of(const DenseCompliance& compliance) {
    const auto n = static_cast<Index>(compliance.dof_count());
    return {compliance.entries.get(), n, n};
}

// In double for a dense matrix; a hierarchical one multiplies as it does at run time.
VectorXd product(const SurfaceCompliance& compliance, const VectorXd& forces) {
    VectorXd result(forces.size());
    if (const auto* dense = std::get_if<DenseCompliance>(&compliance)) {
        const StoredMatrix stored = view_of(*dense);
        for (Index row = 0; row < forces.size(); ++row)
            result[row] = stored.row(row).cast<double>().dot(forces);
        return result;
    }
    std::vector<NodeForce> loads;
    for (Index node = 0; node < forces.size() / 3; ++node)
        loads.push_back({static_cast<std::int32_t>(node), forces.segment<3>(3 * node).cast<float>()});
    std::vector<Eigen::Vector3f> u(loads.size(), Eigen::Vector3f::Zero());
    add_displacements(compliance, loads, u);
    for (std::size_t node = 0; node < u.size(); ++node)
        result.segment<3>(3 * static_cast<Index>(node)) = u[node].cast<double>();
    return result;
}

// Worst difference of a column relative to its largest entry.
double worst_residual(const MatrixXd& found, const MatrixXd& solved) {
    double worst = 0;
    for (Index c = 0; c < solved.cols(); ++c)
        worst = std::max(worst, (found.col(c) - solved.col(c)).cwiseAbs().maxCoeff() /
                                    solved.col(c).cwiseAbs().maxCoeff());
    return worst;
}

MatrixXd stored_columns(const SurfaceCompliance& compliance, const std::vector<Index>& dofs) {
    MatrixXd columns(3 * Index{node_count(compliance)}, static_cast<Index>(dofs.size()));
    for (std::size_t c = 0; c < dofs.size(); ++c)
        for (std::int32_t node = 0; node < node_count(compliance); ++node)
            columns.col(static_cast<Index>(c)).segment<3>(3 * Index{node}) =
                compliance_block(compliance, node, static_cast<std::int32_t>(dofs[c] / 3))
                    .col(dofs[c] % 3)
                    .cast<double>();
    return columns;
}

// Of a hierarchical compliance only diagonal blocks could be asymmetric.
double asymmetry_of(const SurfaceCompliance& compliance) {
    double difference = 0, largest = 0;
    if (const auto* dense = std::get_if<DenseCompliance>(&compliance)) {
        const StoredMatrix stored = view_of(*dense);
        constexpr Index tile = 64;
        for (Index i0 = 0; i0 < stored.rows(); i0 += tile)
            for (Index j0 = 0; j0 <= i0; j0 += tile) {
                const Index h = std::min(tile, stored.rows() - i0), w = std::min(tile, stored.rows() - j0);
                const Eigen::MatrixXf a = stored.block(i0, j0, h, w), b = stored.block(j0, i0, w, h);
                difference = std::max(difference, double{(a - b.transpose()).cwiseAbs().maxCoeff()});
                largest = std::max(largest, double{a.cwiseAbs().maxCoeff()});
            }
        return difference / largest;
    }
    for (std::int32_t node = 0; node < node_count(compliance); ++node) {
        const Eigen::Matrix3f block = compliance_block(compliance, node, node);
        difference = std::max(difference, double{(block - block.transpose()).cwiseAbs().maxCoeff()});
        largest = std::max(largest, double{block.cwiseAbs().maxCoeff()});
    }
    return difference / largest;
}

// Maxwell-Betti: the work of load a on b's displacements equals that of b on a's.
double reciprocity_of(const SurfaceCompliance& compliance, std::uint64_t seed) {
    constexpr int pairs = 4;
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const auto load = [&] {
        // Rounded, so that both products see the same forces.
        return VectorXd(
            VectorXd::NullaryExpr(3 * Index{node_count(compliance)}, [&] { return normal(random); })
                .cast<float>()
                .cast<double>());
    };
    double worst = 0;
    for (int pair = 0; pair < pairs; ++pair) {
        const VectorXd a = load(), b = load();
        const VectorXd u_a = product(compliance, a), u_b = product(compliance, b);
        // Relative to the loads' own energies: a·u_b itself may vanish by chance.
        const double scale = std::sqrt(a.dot(u_a) * b.dot(u_b));
        worst = std::max(worst, std::abs(a.dot(u_b) - b.dot(u_a)) / scale);
    }
    return worst;
}

double smallest_eigenvalue_on(const SurfaceCompliance& compliance, const ContactLoad& load) {
    return Eigen::SelfAdjointEigenSolver<MatrixXd>(compliance_on(compliance, load), Eigen::EigenvaluesOnly)
        .eigenvalues()[0];
}

void try_loads(const DeformableBody& body, const Judge& judge, std::int32_t count, std::uint64_t seed,
               Certificate& certificate) {
    constexpr std::size_t batch = 64;
    const std::vector<ContactLoad> loads = random_contact_loads(body, count, seed);
    certificate.sampled_loads = count;
    certificate.smallest_patch_eigenvalue = std::numeric_limits<double>::max();
    for (std::size_t first = 0; first < loads.size(); first += batch) {
        const auto some = std::span(loads).subspan(first, std::min(batch, loads.size() - first));
        MatrixXd forces = MatrixXd::Zero(dof_count(body), static_cast<Index>(some.size()));
        for (std::size_t k = 0; k < some.size(); ++k)
            for (const NodeForce& force : some[k])
                forces.col(static_cast<Index>(k)).segment<3>(3 * Index{force.node}) +=
                    force.force.cast<double>();
        const MatrixXd exact = judge.displacements(forces, false);
        for (std::size_t k = 0; k < some.size(); ++k) {
            const LoadError error = error_of(body.compliance, some[k], exact.col(static_cast<Index>(k)));
            certificate.load_error = std::max(certificate.load_error, error.surface);
            certificate.contact_error = std::max(certificate.contact_error, error.contact);
            certificate.smallest_patch_eigenvalue = std::min(
                certificate.smallest_patch_eigenvalue, smallest_eigenvalue_on(body.compliance, some[k]));
        }
    }
}

// All that follows from the stored matrix and fresh solutions; returns the re-solved columns.
MatrixXd certify_stored(const DeformableBody& body, const Judge& judge, const std::vector<Index>& dofs,
                        std::int32_t loads, std::uint64_t seed, Certificate& certificate) {
    const MatrixXd solved = judge.columns(dofs, dof_count(body));
    certificate.residual = worst_column_error(body.compliance, dofs, solved);
    certificate.asymmetry = asymmetry_of(body.compliance);
    certificate.reciprocity = reciprocity_of(body.compliance, seed);
    certificate.sampled_columns = static_cast<std::int32_t>(dofs.size());
    certificate.free_dofs = judge.system().stiffness.rows();
    try_loads(body, judge, loads, seed, certificate);
    return solved;
}

}  // namespace

std::vector<Index> sampled_dofs(const DeformableBody& body, std::int32_t columns, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<Index> dofs;
    for (std::int32_t c = 0; c < columns; ++c)
        dofs.push_back(static_cast<Index>(random() % static_cast<std::uint64_t>(dof_count(body))));
    return dofs;
}

double worst_column_error(const SurfaceCompliance& compliance, const std::vector<Index>& dofs,
                          const MatrixXd& solved) {
    return worst_residual(stored_columns(compliance, dofs), solved);
}

SampledColumns certificate_sample(const DeformableBody& body) {
    return {sampled_dofs(body, certificate_columns, certificate_seed), {}};
}

Certificate certify(const DeformableBody& body, const SampledColumns& columns) {
    Certificate certificate;
    const Judge judge(body);
    const MatrixXd solved =
        certify_stored(body, judge, columns.dofs, certificate_loads, certificate_seed, certificate);
    certificate.residual_double = columns.values.size() > 0 ? worst_residual(columns.values, solved) : -1;
    certificate.largest_eigenvalue =
        largest_eigenvalue(dof_count(body), [&](VectorXd& v) { v = judge.displacements(v, false); });
    const InteriorElimination interior(body, judge.system());
    certificate.smallest_eigenvalue =
        1 / largest_eigenvalue(dof_count(body), [&](VectorXd& v) { v = interior.surface_forces(v); });
    certificate.condition_number = certificate.largest_eigenvalue / certificate.smallest_eigenvalue;
    return certificate;
}

Certificate recertify(const DeformableBody& body, std::int32_t columns, std::int32_t loads,
                      std::uint64_t seed) {
    require_no_rigid_motion(body.mesh, body.fixed_nodes);
    Certificate certificate;
    const Index size = dof_count(body);
    {
        const Judge judge(body);
        certify_stored(body, judge, sampled_dofs(body, columns, seed), loads, seed, certificate);
    }
    certificate.largest_eigenvalue =
        largest_eigenvalue(size, [&](VectorXd& v) { v = product(body.compliance, v); });
    const auto* dense = std::get_if<DenseCompliance>(&body.compliance);
    if (dense == nullptr) return certificate;

    MatrixXd factor = view_of(*dense).cast<double>();
    const auto n = static_cast<lapack_int>(size);
    if (LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', n, factor.data(), n) != 0) return certificate;
    certificate.smallest_eigenvalue =
        1 / largest_eigenvalue(size, [&](VectorXd& v) {
            LAPACKE_dpotrs(LAPACK_COL_MAJOR, 'L', n, 1, factor.data(), n, v.data(), n);
        });
    certificate.condition_number = certificate.largest_eigenvalue / certificate.smallest_eigenvalue;
    return certificate;
}

}  // namespace palpate::fem
