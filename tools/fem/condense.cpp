// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/condense.hpp"

#include <algorithm>
#include <cblas.h>
#include <lapacke.h>
#include <utility>

#include "formats/model/errors.hpp"
#include "tools/fem/boundary_conditions.hpp"
#include "tools/fem/certificate.hpp"
#include "tools/fem/eigenvalues.hpp"
#include "tools/fem/ordering.hpp"
#include "tools/fem/sparse_cholesky.hpp"
#include "tools/fem/stiffness.hpp"

namespace palpate {
namespace {

std::vector<std::int32_t> contact_nodes_of(const DeformableBody& body) {
    std::vector<std::int32_t> nodes;
    std::ranges::set_difference(body.boundary.nodes, body.fixed_nodes, std::back_inserter(nodes));
    return nodes;
}

// The matrix with a column that is full below the diagonal: all later columns then fill in, and so stay
// together in one dense block of the factor.
LowerSparse with_full_column(const LowerSparse& matrix, Eigen::Index full) {
    LowerSparse result(matrix.rows(), matrix.cols());
    result.resizeNonZeros(matrix.nonZeros() + matrix.rows());
    const auto* outer = matrix.outerIndexPtr();
    std::int64_t cursor = 0;
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
        result.outerIndexPtr()[column] = cursor;
        std::int64_t row = column == full ? column : matrix.rows();
        const auto append = [&](std::int64_t r, double value) {
            result.innerIndexPtr()[cursor] = r;
            result.valuePtr()[cursor++] = value;
        };
        for (std::int64_t k = outer[column]; k < outer[column + 1]; ++k) {
            for (; row < matrix.innerIndexPtr()[k]; ++row) append(row, 0.0);
            append(matrix.innerIndexPtr()[k], matrix.valuePtr()[k]);
            if (column == full) ++row;
        }
        for (; column == full && row < matrix.rows(); ++row) append(row, 0.0);
    }
    result.outerIndexPtr()[matrix.cols()] = cursor;
    result.resizeNonZeros(cursor);
    return result;
}

}  // namespace

ExactCompliance condense(const DeformableBody& body, const ProgressCallback& progress) {
    require_no_rigid_motion(body.mesh, body.fixed_nodes);
    const auto size = static_cast<Eigen::Index>(3 * body.contact_nodes.size());
    if (size == 0)
        throw InvalidInput(
            {body.name, "every surface node is held, so nothing can be touched", "", "hold fewer nodes"});

    progress("ordering", 0.0);
    const Discretisation discretisation = discretise(body);
    const auto position = surface_last_ordering(discretisation, body.contact_nodes);
    progress("assembling the stiffness", 0.05);
    LowerSparse stiffness = assemble_stiffness(body.mesh, body.materials, discretisation, position);
    stiffness = with_full_column(stiffness, stiffness.cols() - size);
    progress("factorising", 0.1);
    SparseCholesky factor(stiffness, Elimination::as_given);
    stiffness = LowerSparse();

    SparseCholesky::Block block = factor.trailing_block(size);
    const auto n = static_cast<blasint>(size), stride = static_cast<blasint>(block.outerStride());
    const double smallest = 1.0 / largest_eigenvalue(size, [&](Eigen::VectorXd& v) {
                                cblas_dtrmv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, n, block.data(),
                                            stride, v.data(), 1);
                                cblas_dtrmv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, n,
                                            block.data(), stride, v.data(), 1);
                            });
    progress("inverting the surface block", 0.6);
    const int status = LAPACKE_dpotri(LAPACK_COL_MAJOR, 'L', n, block.data(), stride);
    if (status != 0)
        throw InvalidInput({body.name, "its surface stiffness is singular at row " + std::to_string(status),
                            "", "hold more nodes"});
    Eigen::VectorXd product(size);
    const double largest = largest_eigenvalue(size, [&](Eigen::VectorXd& v) {
        cblas_dsymv(CblasColMajor, CblasLower, n, 1.0, block.data(), stride, v.data(), 1, 0.0, product.data(), 1);
        v.swap(product);
    });
    return {std::move(factor), block, smallest, largest};
}

DenseCompliance to_stored(const Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>& lower) {
    const auto n = static_cast<std::size_t>(lower.rows());
    std::shared_ptr<float[]> entries(new float[n * n]);
    // Tiles keep both triangles' writes in cache.
    constexpr std::size_t tile = 64;
    for (std::size_t i0 = 0; i0 < n; i0 += tile)
        for (std::size_t j0 = 0; j0 <= i0; j0 += tile)
            for (std::size_t j = j0; j < std::min(j0 + tile, n); ++j)
                for (std::size_t i = std::max(i0, j); i < std::min(i0 + tile, n); ++i) {
                    const auto value =
                        static_cast<float>(lower(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
                    entries[i * n + j] = value;
                    entries[j * n + i] = value;
                }
    return {static_cast<std::int32_t>(n / 3), std::shared_ptr<const float>(entries, entries.get())};
}

DeformableBody condensed_body(DeformableBody body, const ProgressCallback& progress) {
    body.boundary = boundary_surface(body.mesh);
    body.contact_nodes = contact_nodes_of(body);
    const ExactCompliance exact = condense(body, progress);
    progress("storing", 0.8);
    body.compliance = to_stored(exact.lower);
    progress("certifying", 0.85);
    body.certificate = certify(body, exact);
    return body;
}

}  // namespace palpate
