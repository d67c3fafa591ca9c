// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/condensation/condensation_plan.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <limits>

#include "formats/model/errors.hpp"
#include "tools/fem/solvers/dense_kernels.hpp"
#include "tools/fem/solvers/free_system.hpp"

namespace palpate::fem {
namespace {

// Parts of the dense kernels' speed that the methods reach, and the part of a factor that a panel of
// neighbouring loads passes through, down and up: with them the seconds that bench_condensation measured on 1
// 200 to 5 000 surface nodes are 0.75 to 1.4 times the forecast's.
constexpr double trailing_efficiency = 0.7, solve_efficiency = 0.3, solve_part = 0.65;
// A hierarchical compliance takes about this many bytes a node, times log2(nodes) and decimal digits;
// measured at three digits, 150 to 215 for 2 300 to 20 000 nodes.
constexpr double hierarchical_bytes = 230;
// Flops that compressing takes for each entry of C, the panels left out.
constexpr double flops_per_entry = 240;
constexpr double panel_loads = 96;

std::string mebibytes(double bytes) {
    return fmt::format("{:.0f} MiB", std::ceil(bytes / 0x1p20));
}

CondensationForecast forecast_trailing_block(const DeformableBody& body, const CondensationOptions& options,
                                             double flops_per_second) {
    const FreeSystem system = assemble_free_system(body, NodeOrder::surface_last);
    const FactorForecast factor = SparseCholesky::forecast(system.stiffness, Elimination::as_given);
    const auto n = static_cast<double>(system.contact_rows.size());
    return {.method = CondensationMethod::trailing_block,
            .seconds = (factor.flops + 2.0 / 3 * n * n * n) /
                       (flops_per_second * trailing_efficiency * options.threads),
            .memory_bytes = 8 * (factor.entries + std::max(factor.work_entries, n * n / 2)),
            .size_bytes = 4 * n * n};
}

std::vector<CondensationForecast> forecast_solves(const DeformableBody& body,
                                                  const CondensationOptions& options,
                                                  double flops_per_second) {
    const FreeSystem system = assemble_free_system(body, NodeOrder::nested_dissection);
    const FactorForecast factor = SparseCholesky::forecast(system.stiffness, Elimination::as_given);
    const auto n = static_cast<double>(system.contact_rows.size());
    const double rate = flops_per_second * solve_efficiency * options.threads;
    const double seconds = (factor.flops + 4 * n * factor.entries * solve_part) / rate;
    const double working = 8 * (factor.entries + 2 * static_cast<double>(system.stiffness.rows()) *
                                                     panel_loads * options.threads);
    const double digits = std::max(1.0, -std::log10(options.accuracy));
    const double nodes = n / 3, size = hierarchical_bytes * nodes * std::log2(nodes + 2) * digits;
    return {{CondensationMethod::solves, seconds, working + 12 * n * n, 4 * n * n},
            {CondensationMethod::hierarchical, seconds + flops_per_entry * n * n / rate, working + 3 * size,
             std::min(size, 4 * n * n)}};
}

bool fits(const CondensationForecast& forecast, double memory, double size) {
    return forecast.memory_bytes <= memory && forecast.size_bytes <= size;
}

}  // namespace

std::string name_of(CondensationMethod method) {
    switch (method) {
        case CondensationMethod::trailing_block:
            return "trailing block";
        case CondensationMethod::solves:
            return "panels of solves";
        case CondensationMethod::hierarchical:
            return "hierarchical";
    }
    return "";
}

double available_memory() {
    std::ifstream meminfo("/proc/meminfo");
    std::string key;
    for (double kibibytes = 0; meminfo >> key >> kibibytes; meminfo.ignore(64, '\n'))
        if (key == "MemAvailable:") return kibibytes * 1024;
    return std::numeric_limits<double>::infinity();
}

CondensationPlan plan_condensation(const DeformableBody& body, const CondensationOptions& options) {
    const double memory = options.memory_bytes > 0 ? options.memory_bytes : available_memory();
    const double rate = dense_flops_per_second();
    CondensationPlan plan;
    plan.accuracy = options.accuracy;
    plan.threads = options.threads;
    plan.considered = forecast_solves(body, options, rate);
    plan.considered.insert(plan.considered.begin(), forecast_trailing_block(body, options, rate));

    const auto chosen = [&](Representation wanted) {
        const CondensationForecast* best = nullptr;
        for (const CondensationForecast& forecast : plan.considered) {
            const bool hierarchical = forecast.method == CondensationMethod::hierarchical;
            if (hierarchical != (wanted == Representation::hierarchical)) continue;
            if (fits(forecast, memory, options.size_bytes) && (!best || forecast.seconds < best->seconds))
                best = &forecast;
        }
        return best;
    };
    const CondensationForecast& leanest_exact =
        std::ranges::min(plan.considered[0], plan.considered[1], {}, &CondensationForecast::memory_bytes);
    const CondensationForecast* best = nullptr;
    if (options.representation != Representation::hierarchical) best = chosen(Representation::dense);
    plan.reason = "exact, and the faster way to it";
    if (!best && options.representation != Representation::dense) {
        best = chosen(Representation::hierarchical);
        plan.reason = options.representation == Representation::hierarchical
                          ? "asked for"
                          : fmt::format("an exact one takes {} of {} memory and {} of {} size",
                                        mebibytes(leanest_exact.memory_bytes), mebibytes(memory),
                                        mebibytes(leanest_exact.size_bytes), mebibytes(options.size_bytes));
    }
    if (!best) {
        const CondensationForecast& least =
            options.representation == Representation::dense ? leanest_exact : plan.considered[2];
        throw InvalidInput(
            {body.name,
             fmt::format("its compliance of {} contact nodes would take {} of memory and {} of size, {}",
                         body.contact_nodes.size(), mebibytes(least.memory_bytes),
                         mebibytes(least.size_bytes), name_of(least.method)),
             fmt::format("at most {} of memory and {} of size", mebibytes(memory),
                         mebibytes(options.size_bytes)),
             "allow more with --memory or --size, ask for less with --accuracy or --representation "
             "hierarchical, "
             "narrow the contact surface with --contact, or mesh with larger cells"});
    }
    plan.chosen = *best;
    return plan;
}

}  // namespace palpate::fem
