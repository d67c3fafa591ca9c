// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/solvers/interior_elimination.hpp"

#include "formats/model/errors.hpp"

namespace palpate::fem {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// The rows and columns of a lower triangle that `rows` (ascending) lists.
elasticity::LowerSparse submatrix(const elasticity::LowerSparse& matrix,
                                  const std::vector<std::int64_t>& rows) {
    std::vector<std::int64_t> renumbered(static_cast<std::size_t>(matrix.rows()), -1);
    for (std::size_t k = 0; k < rows.size(); ++k) renumbered[rows[k]] = static_cast<std::int64_t>(k);
    std::vector<Eigen::Triplet<double, std::int64_t>> entries;
    for (const std::int64_t column : rows)
        for (elasticity::LowerSparse::InnerIterator entry(matrix, column); entry; ++entry)
            if (const std::int64_t row = renumbered[entry.row()]; row >= 0)
                entries.emplace_back(row, renumbered[column], entry.value());
    elasticity::LowerSparse result(static_cast<Index>(rows.size()), static_cast<Index>(rows.size()));
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

}  // namespace

InteriorElimination::InteriorElimination(const DeformableBody& body, const FreeSystem& system)
    : system_(system) {
    std::vector<char> contact(static_cast<std::size_t>(system.stiffness.rows()), 0);
    for (const std::int64_t row : system.contact_rows) contact[row] = 1;
    for (std::size_t row = 0; row < contact.size(); ++row)
        if (contact[row] == 0) interior_rows_.push_back(static_cast<std::int64_t>(row));
    if (interior_rows_.empty()) return;
    try {
        interior_.emplace(submatrix(system.stiffness, interior_rows_), Elimination::fill_reducing);
    } catch (const NotPositiveDefinite&) {
        throw InvalidInput({body.name, "its interior stiffness is not positive definite", "",
                            "mesh again: a tetrahedron inside may be degenerate"});
    }
}

VectorXd InteriorElimination::surface_forces(const VectorXd& displacements) const {
    VectorXd u = VectorXd::Zero(system_.stiffness.rows());
    for (std::size_t dof = 0; dof < system_.contact_rows.size(); ++dof)
        u[system_.contact_rows[dof]] = displacements[static_cast<Index>(dof)];
    VectorXd forces = system_.stiffness.selfadjointView<Eigen::Lower>() * u;
    if (interior_) {
        VectorXd inside(static_cast<Index>(interior_rows_.size()));
        for (Index k = 0; k < inside.size(); ++k) inside[k] = forces[interior_rows_[k]];
        const VectorXd yielded = interior_->solve(inside);
        for (Index k = 0; k < inside.size(); ++k) u[interior_rows_[k]] = -yielded[k];
        forces = system_.stiffness.selfadjointView<Eigen::Lower>() * u;
    }
    VectorXd result(displacements.size());
    for (std::size_t dof = 0; dof < system_.contact_rows.size(); ++dof)
        result[static_cast<Index>(dof)] = forces[system_.contact_rows[dof]];
    return result;
}

}  // namespace palpate::fem
