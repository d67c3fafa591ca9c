// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/benchmarks/condensation/methods.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <algorithm>
#include <lapacke.h>
#include <optional>
#include <thread>

#include "formats/model/errors.hpp"
#include "tests/benchmarks/condensation/hierarchical.hpp"
#include "tools/fem/certificate/certificate.hpp"
#include "tools/fem/condensation/condense.hpp"
#include "tools/fem/solvers/dense_kernels.hpp"
#include "tools/fem/solvers/free_system.hpp"
#include "tools/fem/solvers/sparse_cholesky.hpp"

namespace palpate {
namespace {

using namespace fem;

Eigen::Index surface_dofs(const DeformableBody& body) {
    return static_cast<Eigen::Index>(3 * body.contact_nodes.size());
}

// Seconds from each report of progress to the next, the last one until now.
class Stages {
  public:
    ProgressCallback callback() {
        return [this](std::string_view what, double) {
            if (!names_.empty() && names_.back() == what) return;
            names_.emplace_back(what);
            begins_.push_back(now_seconds());
        };
    }
    Json to_json() const {
        const double end = now_seconds();
        Json stages = Json::object();
        for (std::size_t i = 0; i < names_.size(); ++i)
            stages[names_[i]] = (i + 1 < names_.size() ? begins_[i + 1] : end) - begins_[i];
        return stages;
    }

  private:
    std::vector<std::string> names_;
    std::vector<double> begins_;
};

using ExactWay = ExactCompliance (*)(const DeformableBody&, int threads, const ProgressCallback&);

ExactCompliance by_trailing_block(const DeformableBody& body, int, const ProgressCallback& progress) {
    return condense_by_trailing_block(body, progress);
}

Json measure_exact_way(const DeformableBody& held, int threads, ExactWay condense) {
    set_linear_algebra_threads(threads);
    std::optional<ExactCompliance> exact;
    Stages stages;
    Json stage_seconds;
    const Cost cost = cost_of([&] {
        exact.emplace(condense(held, threads, stages.callback()));
        stage_seconds = stages.to_json();
    });
    DeformableBody body = held;
    SampledColumns columns = certificate_sample(body);
    columns.values = columns_of(*exact, columns.dofs);
    body.compliance = to_stored(*exact);
    exact.reset();
    const Certificate certificate = certify(body, columns);
    Json result = to_json(cost);
    result["bytes"] = value_bytes(body.compliance);
    result["stages"] = stage_seconds;
    result["residual_double"] = certificate.residual_double;
    result["residual_stored"] = certificate.residual;
    result["condition_number"] = certificate.condition_number;
    return result;
}

// What the plan chooses and how long it takes, in a process of its own, so that it leaves no memory behind.
Json planned(const DeformableBody& body, int threads) {
    return in_child([&] {
        const double begin = now_seconds();
        const CondensationPlan plan = plan_condensation(
            body,
            {.representation = Representation::dense, .size_bytes = available_memory(), .threads = threads});
        return Json{{"planning_seconds", now_seconds() - begin},
                    {"chosen", name_of(plan.chosen.method)},
                    {"forecast_seconds", plan.chosen.seconds},
                    {"forecast_bytes", plan.chosen.memory_bytes}};
    });
}

Json measure_exact(const DeformableBody& body, int threads) {
    const Json plan = planned(body, threads);
    const bool solves = plan["chosen"] == name_of(CondensationMethod::solves);
    Json result = measure_exact_way(body, threads, solves ? condense_by_solves : by_trailing_block);
    result.update(plan);
    return result;
}

Json measure_lapack(const DeformableBody& body, int threads) {
    set_linear_algebra_threads(threads);
    const Eigen::Index n = surface_dofs(body);
    // Any positive definite matrix takes the same time; this one is far from singular.
    Eigen::MatrixXd matrix(n, n);
    std::uint64_t state = 1;
    for (Eigen::Index j = 0; j < n; ++j)
        for (Eigen::Index i = 0; i < n; ++i) {
            state = 6364136223846793005U * state + 1442695040888963407U;
            matrix(i, j) = i == j ? static_cast<double>(n) : 0x1p-53 * static_cast<double>(state >> 11);
        }
    const auto order = static_cast<lapack_int>(n);
    int status = 0;
    const Cost cost = cost_of([&] {
        status = LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', order, matrix.data(), order);
        if (status == 0) status = LAPACKE_dpotri_work(LAPACK_COL_MAJOR, 'L', order, matrix.data(), order);
    });
    if (status != 0) throw SystemFailure({"LAPACK", "returned " + std::to_string(status), "0", ""});
    return to_json(cost);
}

Json measure_cholmod(const DeformableBody& body, int threads) {
    set_linear_algebra_threads(threads);
    constexpr Eigen::Index panel = 256;
    constexpr double patience = 60;  // s
    const Eigen::Index n = surface_dofs(body), panels = (n + panel - 1) / panel;
    Eigen::MatrixXd compliance(n, n);
    double factor_seconds = 0, solve_seconds = 0;
    Eigen::Index solved = 0;
    const Cost cost = cost_of([&] {
        const double begin = now_seconds();
        const FreeSystem system = assemble_free_system(body, NodeOrder::as_numbered);
        const elasticity::LowerSparse& stiffness = system.stiffness;
        const std::vector<std::int64_t>& rows = system.contact_rows;
        const SparseCholesky factor(stiffness, Elimination::fill_reducing);
        factor_seconds = now_seconds() - begin;
        for (Eigen::Index p = 0; p < panels && solve_seconds < patience; ++p) {
            const Eigen::Index first = p * panel, width = std::min(panel, n - first);
            Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(stiffness.rows(), width);
            for (Eigen::Index c = 0; c < width; ++c) loads(rows[static_cast<std::size_t>(first + c)], c) = 1;
            const Eigen::MatrixXd u = factor.solve(loads);
            for (Eigen::Index c = 0; c < width; ++c)
                for (Eigen::Index dof = 0; dof < n; ++dof)
                    compliance(dof, first + c) = u(rows[static_cast<std::size_t>(dof)], c);
            solved += width;
            solve_seconds = now_seconds() - begin - factor_seconds;
        }
    });
    const double scale = static_cast<double>(n) / static_cast<double>(solved);
    Json result = to_json(cost);
    result["seconds"] = factor_seconds + scale * solve_seconds;
    result["cpu_seconds"] = cost.cpu_seconds * (factor_seconds + scale * solve_seconds) / cost.seconds;
    result["factor_seconds"] = factor_seconds;
    result["solved_columns"] = solved;
    result["columns"] = n;
    return result;
}

// Column-sorted rows, both triangles: what a product by rows needs.
using FullSparse = Eigen::SparseMatrix<double, Eigen::RowMajor, std::int64_t>;

struct Iterations {
    double tolerance;
    int limit;
};

template <typename Preconditioner>
Json measure_iterative(const DeformableBody& body, int threads, const Iterations& until) {
    constexpr Eigen::Index sample = 32;
    const FullSparse stiffness =
        assemble_free_system(body, NodeOrder::as_numbered).stiffness.selfadjointView<Eigen::Lower>();
    const Eigen::Index n = stiffness.rows();
    std::vector<Eigen::Index> iterations(sample);
    // Columns one after the other in each thread, so that none waits for another.
    const auto solve_every = [&](Eigen::Index first, Eigen::Index step) {
        Eigen::ConjugateGradient<FullSparse, Eigen::Lower | Eigen::Upper, Preconditioner> solver(stiffness);
        solver.setTolerance(until.tolerance);
        solver.setMaxIterations(until.limit);
        for (Eigen::Index c = first; c < sample; c += step) {
            const Eigen::VectorXd u = solver.solve(Eigen::VectorXd::Unit(n, c * n / sample));
            iterations[static_cast<std::size_t>(c)] = u.allFinite() ? solver.iterations() : -1;
        }
    };
    const Cost cost = cost_of([&] {
        std::vector<std::jthread> workers;
        for (int t = 0; t < threads; ++t) workers.emplace_back(solve_every, t, threads);
    });
    const double scale = static_cast<double>(n) / static_cast<double>(sample);
    Json result = to_json(cost);
    result["seconds"] = scale * cost.seconds;
    result["cpu_seconds"] = scale * cost.cpu_seconds;
    result["solved_columns"] = sample;
    result["columns"] = n;
    result["fewest_iterations"] = *std::ranges::min_element(iterations);
    result["most_iterations"] = *std::ranges::max_element(iterations);
    return result;
}

double doubles_squared(double surface_dofs) {
    return 8 * surface_dofs * surface_dofs;
}

double exact_memory(double surface_dofs) {
    return 2.5 * doubles_squared(surface_dofs);
}

}  // namespace

const std::vector<Method>& condensation_methods() {
    static const std::vector<Method> methods{
        {"exact", true, exact_memory, measure_exact},
        {"trailing", true, exact_memory,
         [](const DeformableBody& body, int threads) {
             return measure_exact_way(body, threads, by_trailing_block);
         }},
        {"solves", true, exact_memory,
         [](const DeformableBody& body, int threads) {
             return measure_exact_way(body, threads, condense_by_solves);
         }},
        {"lapack", true, doubles_squared, measure_lapack},
        {"cholmod", false, [](double n) { return 2 * doubles_squared(n); }, measure_cholmod},
        {"iterative", false, [](double) { return 0.0; },
         [](const DeformableBody& body, int threads) {
             return measure_iterative<Eigen::IdentityPreconditioner>(body, threads, {1e-20, 5000});
         }},
        {"iterative_loose", false, [](double) { return 0.0; },
         [](const DeformableBody& body, int threads) {
             return measure_iterative<Eigen::DiagonalPreconditioner<double>>(body, threads, {1e-6, 5000});
         }},
        {"hierarchical", false, [](double) { return 0.0; }, measure_hierarchical},
    };
    return methods;
}

}  // namespace palpate
