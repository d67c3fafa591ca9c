// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/condensation/condense.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cblas.h>
#include <lapacke.h>
#include <mutex>
#include <optional>
#include <utility>

#include "formats/model/errors.hpp"
#include "tools/fem/assembly/node_rules.hpp"
#include "tools/fem/assembly/rigid_motions.hpp"
#include "tools/fem/certificate/certificate.hpp"
#include "tools/fem/certificate/contact_loads.hpp"
#include "tools/fem/condensation/cluster_order.hpp"
#include "tools/fem/condensation/compress.hpp"
#include "tools/fem/condensation/sway.hpp"
#include "tools/fem/solvers/dense_kernels.hpp"
#include "tools/fem/solvers/free_system.hpp"
#include "tools/fem/solvers/panel_solver.hpp"

namespace palpate::fem {
namespace {

using Eigen::Index;

// The matrix with a column that is full below the diagonal: all later columns then fill in, and so stay
// together in one dense block of the factor.
elasticity::LowerSparse with_full_column(const elasticity::LowerSparse& matrix, Eigen::Index full) {
    elasticity::LowerSparse result(matrix.rows(), matrix.cols());
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

// The factor of a nested dissection and the contact rows of its solutions.
struct SurfaceSolver {
    SparseCholesky factor;
    PanelSolver panels;
    std::vector<std::int64_t> contact_rows;

    SurfaceSolver(const DeformableBody& body, const FreeSystem& system)
        : factor(factorise(body, system, Elimination::as_given)),
          panels(factor, system.contact_rows),
          contact_rows(system.contact_rows) {}

    // Rows of C that belong to contact nodes, 3|nodes| x 3m.
    Eigen::MatrixXd rows(std::span<const std::int32_t> nodes) const {
        std::vector<PanelLoad> unit_loads;
        for (const std::int32_t node : nodes)
            for (std::size_t axis = 0; axis < 3; ++axis)
                unit_loads.push_back({contact_rows[3 * static_cast<std::size_t>(node) + axis],
                                      static_cast<Index>(unit_loads.size()), 1.0});
        return panels.solve(unit_loads, static_cast<Index>(unit_loads.size()));
    }

    // Displacements of the contact nodes under each load, loads x 3m.
    Eigen::MatrixXd displacements(std::span<const ContactLoad> loads) const {
        std::vector<PanelLoad> entries;
        for (std::size_t k = 0; k < loads.size(); ++k)
            for (const NodeForce& force : loads[k])
                for (Index axis = 0; axis < 3; ++axis)
                    entries.push_back({contact_rows[3 * Index{force.node} + axis], static_cast<Index>(k),
                                       double{force.force[axis]}});
        return panels.solve(entries, static_cast<Index>(loads.size()));
    }
};

SurfaceSolver surface_solver(const DeformableBody& body, const ProgressCallback& progress) {
    progress("ordering and assembling", 0.0);
    const FreeSystem system = assemble_free_system(body, NodeOrder::nested_dissection);
    progress("factorising", 0.02);
    return {body, system};
}

std::vector<Eigen::Vector3d> contact_points(const DeformableBody& body) {
    std::vector<Eigen::Vector3d> points;
    for (const std::int32_t node : body.contact_nodes) points.push_back(body.mesh.rest_positions[node]);
    return points;
}

// What certificate and verify find in a compliance, worst of both.
struct Trial {
    double worst_error = 0;         // of displacements, whole and at loaded nodes, and of columns' entries
    bool positive_definite = true;  // on the nodes of every load
};

Trial tried(const DeformableBody& body, const SurfaceSolver& solver, const SurfaceCompliance& compliance) {
    constexpr std::size_t batch = 128;  // whose exact displacements are held at once
    Trial trial;
    for (const std::uint64_t seed : {certificate_seed, recheck_seed}) {
        const std::vector<ContactLoad> loads = random_contact_loads(body, certificate_loads, seed);
        for (std::size_t first = 0; first < loads.size(); first += batch) {
            const auto some = std::span(loads).subspan(first, std::min(batch, loads.size() - first));
            const Eigen::MatrixXd exact = solver.displacements(some).transpose();
            for (std::size_t k = 0; k < some.size(); ++k) {
                const LoadError error = error_of(compliance, some[k], exact.col(static_cast<Index>(k)));
                trial.worst_error = std::max({trial.worst_error, error.surface, error.contact});
                trial.positive_definite &= compliance_on(compliance, some[k]).llt().info() == Eigen::Success;
            }
        }
        const std::vector<Index> dofs = sampled_dofs(body, certificate_columns, seed);
        std::vector<ContactLoad> newtons;
        for (const Index dof : dofs)
            newtons.push_back({{static_cast<std::int32_t>(dof / 3), Eigen::Vector3f::Unit(dof % 3)}});
        trial.worst_error =
            std::max(trial.worst_error,
                     worst_column_error(compliance, dofs, solver.displacements(newtons).transpose()));
    }
    return trial;
}

}  // namespace

Eigen::MatrixXd columns_of(const ExactCompliance& exact, std::span<const Index> dofs) {
    const Index size = exact.lower.rows();
    Eigen::MatrixXd columns(size, static_cast<Index>(dofs.size()));
    for (std::size_t c = 0; c < dofs.size(); ++c)
        columns.col(static_cast<Index>(c)) << exact.lower.row(dofs[c]).head(dofs[c]).transpose(),
            exact.lower.col(dofs[c]).tail(size - dofs[c]);
    return columns;
}

ExactCompliance condense_by_trailing_block(const DeformableBody& body, const ProgressCallback& progress) {
    progress("ordering and assembling", 0.0);
    FreeSystem system = assemble_free_system(body, NodeOrder::surface_last);
    const auto size = static_cast<Index>(system.contact_rows.size());
    system.stiffness = with_full_column(system.stiffness, system.stiffness.cols() - size);
    progress("factorising", 0.05);
    const auto factor = std::make_shared<SparseCholesky>(factorise(body, system, Elimination::as_given));

    progress("inverting the surface block", 0.5);
    SparseCholesky::Block block = factor->trailing_block(size);
    const int status = LAPACKE_dpotri(LAPACK_COL_MAJOR, 'L', static_cast<lapack_int>(size), block.data(),
                                      static_cast<lapack_int>(block.outerStride()));
    if (status != 0)
        throw InvalidInput({body.name, "its surface stiffness is singular at row " + std::to_string(status),
                            "", "hold more nodes"});
    return {factor, {block.data(), size, size, Eigen::OuterStride<>(block.outerStride())}};
}

ExactCompliance condense_by_solves(const DeformableBody& body, int threads,
                                   const ProgressCallback& progress) {
    constexpr std::size_t panel_nodes = 64;
    const SurfaceSolver solver = surface_solver(body, progress);
    const auto size = static_cast<Index>(solver.contact_rows.size());
    const auto lower = std::make_shared<Eigen::MatrixXd>(size, size);
    const std::size_t nodes = body.contact_nodes.size(), panels = (nodes + panel_nodes - 1) / panel_nodes;
    // Neighbours solved together pass through fewer of the factor's columns.
    const std::vector<std::int32_t> order = cluster_order(
        contact_points(body),
        cluster_depth(static_cast<std::int32_t>(nodes), static_cast<std::int32_t>(panel_nodes)));
    std::mutex telling;
    std::size_t done = 0;
    for_each_index(panels, threads, [&](std::size_t panel) {
        const auto loaded = std::span(order)
                                .subspan(panel * panel_nodes)
                                .first(std::min(panel_nodes, nodes - panel * panel_nodes));
        const Eigen::MatrixXd rows = solver.rows(loaded);
        // Column j from the diagonal down is row j, since C is symmetric.
        for (std::size_t k = 0; k < loaded.size(); ++k)
            for (Index axis = 0; axis < 3; ++axis) {
                const Index column = 3 * Index{loaded[k]} + axis;
                lower->col(column).tail(size - column) =
                    rows.row(3 * static_cast<Index>(k) + axis).tail(size - column).transpose();
            }
        const std::lock_guard lock(telling);
        progress("solving", 0.1 + 0.9 * static_cast<double>(++done) / static_cast<double>(panels));
    });
    return {lower, {lower->data(), size, size, Eigen::OuterStride<>(size)}};
}

HierarchicalCompliance condense_hierarchically(const DeformableBody& body, double accuracy, int threads,
                                               const ProgressCallback& progress) {
    // Blocks are truncated to a part of the accuracy, because near a contact errors of neighbouring blocks
    // add up; a second attempt is rarely needed.
    constexpr double share = 0.8, second_share = 0.7;
    constexpr double margin = 0.9;  // certificate and verify solve for the same loads in another order
    constexpr double definite =
        0.1;  // what pulls where it is pressed is off by far more than its errors tell
    const SurfaceSolver solver = surface_solver(body, progress);
    const ComplianceRows rows = [&](std::span<const std::int32_t> nodes) { return solver.rows(nodes); };
    double tolerance = share * accuracy;
    for (int attempt = 0; attempt < 3; ++attempt) {
        HierarchicalCompliance compliance =
            compress(contact_points(body), rows, tolerance, threads,
                     [&](std::string_view what, double fraction) { progress(what, 0.05 + 0.9 * fraction); });
        compliance.accuracy = accuracy;
        const Trial trial = tried(body, solver, compliance);
        if (trial.positive_definite && trial.worst_error <= margin * accuracy) return compliance;
        tolerance *= trial.positive_definite ? second_share * accuracy / trial.worst_error : definite;
    }
    const Sway sway = sway_of(body, solver.displacements(spread_newtons(body)));
    if (hangs(body, sway))
        throw InvalidInput({body.name, hanging_text(sway) + ", and floats do not tell dents in it", "",
                            "hold it there too ('fixed'), or thicken what links it ('close_mm')"});
    throw InvalidInput({body.name, "its compliance could not be compressed to the accuracy asked for", "",
                        "ask for less with --accuracy, or for --representation dense"});
}

DenseCompliance to_stored(const ExactCompliance& exact) {
    const auto n = static_cast<std::size_t>(exact.lower.rows());
    std::shared_ptr<float[]> entries(new float[n * n]);
    // Tiles keep both triangles' writes in cache.
    constexpr std::size_t tile = 64;
    for (std::size_t i0 = 0; i0 < n; i0 += tile)
        for (std::size_t j0 = 0; j0 <= i0; j0 += tile)
            for (std::size_t j = j0; j < std::min(j0 + tile, n); ++j)
                for (std::size_t i = std::max(i0, j); i < std::min(i0 + tile, n); ++i) {
                    const auto value =
                        static_cast<float>(exact.lower(static_cast<Index>(i), static_cast<Index>(j)));
                    entries[i * n + j] = value;
                    entries[j * n + i] = value;
                }
    return {static_cast<std::int32_t>(n / 3), std::shared_ptr<const float>(entries, entries.get())};
}

DeformableBody prepared_body(DeformableBody body) {
    body.boundary = boundary_surface(body.mesh);
    body.contact_nodes = contact_surface_of(body);
    require_no_rigid_motion(body.mesh, body.fixed_nodes);
    return body;
}

DeformableBody condensed_body(DeformableBody body, const CondensationPlan& plan,
                              const ProgressCallback& progress) {
    constexpr double certifying = 0.85;
    const ProgressCallback condensing = [&](std::string_view what, double fraction) {
        progress(what, certifying * fraction);
    };
    std::optional<ExactCompliance> exact;
    if (plan.chosen.method == CondensationMethod::hierarchical)
        body.compliance = condense_hierarchically(body, plan.accuracy, plan.threads, condensing);
    else if (plan.chosen.method == CondensationMethod::solves)
        exact.emplace(condense_by_solves(body, plan.threads, condensing));
    else
        exact.emplace(condense_by_trailing_block(body, condensing));

    SampledColumns columns = certificate_sample(body);
    if (exact) {
        columns.values = columns_of(*exact, columns.dofs);
        body.compliance = to_stored(*exact);
        exact.reset();
    }
    progress("certifying", certifying);
    body.certificate = certify(body, columns);
    return body;
}

DeformableBody condensed_body(DeformableBody body, const ProgressCallback& progress) {
    body = prepared_body(std::move(body));
    const CondensationPlan plan = plan_condensation(body, {.threads = linear_algebra_threads()});
    return condensed_body(std::move(body), plan, progress);
}

}  // namespace palpate::fem
