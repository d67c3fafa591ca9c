// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/benchmarks/condensation/figures.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>

namespace palpate {
namespace {

using ByMethod = std::map<std::string, Json>;

// The fastest of each method's measurements.
ByMethod fastest(const std::vector<Json>& measurements) {
    ByMethod best;
    for (const Json& m : measurements) {
        const auto [entry, added] = best.try_emplace(m["method"], m);
        if (!added && m["seconds"] < entry->second["seconds"]) entry->second = m;
    }
    return best;
}

std::optional<double> number(const ByMethod& best, const char* method, const char* key) {
    const auto found = best.find(method);
    if (found == best.end()) return std::nullopt;
    return found->second.at(key).get<double>();
}

using Value = std::function<std::optional<double>(const ByMethod&)>;  // none if not measured

Value value_of(const char* method, const char* key, double unit = 1) {
    return [=](const ByMethod& best) -> std::optional<double> {
        if (const auto value = number(best, method, key)) return *value / unit;
        return std::nullopt;
    };
}

Value ratio(const char* above, const char* below, const char* key) {
    return [=](const ByMethod& best) -> std::optional<double> {
        const auto numerator = number(best, above, key), denominator = number(best, below, key);
        if (numerator && denominator) return *numerator / *denominator;
        return std::nullopt;
    };
}

std::optional<double> peak_over_block(const ByMethod& best) {
    const auto peak = number(best, "exact", "peak_bytes"), stored = number(best, "exact", "bytes");
    if (peak && stored) return *peak / (2 * *stored);
    return std::nullopt;
}

struct Limit {
    bool at_most;
    double value;
    double fewest_nodes, most_nodes;  // surfaces that it is meant for
};

constexpr double any = std::numeric_limits<double>::infinity();

Limit at_most(double value, double fewest_nodes = 0, double most_nodes = any) {
    return {true, value, fewest_nodes, most_nodes};
}

Limit at_least(double value, double fewest_nodes = 0, double most_nodes = any) {
    return {false, value, fewest_nodes, most_nodes};
}

struct Rule {
    const char* name;
    Value value;
    std::vector<Limit> limits;  // the first that is meant for the surface holds
};

std::vector<Rule> rules() {
    constexpr double largest = 21000;  // surface nodes
    return {
        {"exact / LAPACK, wall", ratio("exact", "lapack", "seconds"), {at_most(1.6, 1900, 5200)}},
        {"exact / LAPACK, processor", ratio("exact", "lapack", "cpu_seconds"), {}},
        {"peak memory / block in double", peak_over_block, {at_most(2.5)}},
        {"CHOLMOD solves / exact", ratio("cholmod", "exact", "seconds"), {at_least(3, 3900)}},
        {"iterative as SOFA / exact", ratio("iterative", "exact", "seconds"), {at_least(200)}},
        {"iterative to 1e-6 / exact", ratio("iterative_loose", "exact", "seconds"), {}},
        {"residual in double", value_of("exact", "residual_double"), {at_most(1e-10)}},
        {"residual as stored", value_of("exact", "residual_stored"), {at_most(1e-6)}},
        {"hierarchical: error", value_of("hierarchical", "error"), {at_most(1e-3)}},
        {"hierarchical: MB",
         value_of("hierarchical", "bytes", 1e6),
         {at_most(50, 0, 5200), at_most(1073, 5200, largest)}},
        {"hierarchical: minutes", value_of("hierarchical", "seconds", 60), {at_most(45, 0, largest)}},
        {"hierarchical: peak GB", value_of("hierarchical", "peak_bytes", 1e9), {at_most(16, 0, largest)}},
        {"hierarchical: C_cc of 32 nodes, us",
         value_of("hierarchical", "block_us"),
         {at_most(200, 0, largest)}},
        {"hierarchical: displacements, ms",
         value_of("hierarchical", "displacements_ms"),
         {at_most(5, 0, largest)}},
    };
}

}  // namespace

std::vector<Figure> figures_of(const std::vector<Json>& measurements) {
    std::vector<Figure> figures;
    if (measurements.empty()) return figures;
    const ByMethod best = fastest(measurements);
    const double nodes = measurements.front()["surface_nodes"];
    for (const Rule& rule : rules()) {
        const auto value = rule.value(best);
        if (!value) continue;
        Figure& figure = figures.emplace_back(Figure{rule.name, *value, "", std::nullopt});
        const auto limit = std::ranges::find_if(
            rule.limits, [&](const Limit& l) { return nodes >= l.fewest_nodes && nodes <= l.most_nodes; });
        if (limit == rule.limits.end()) continue;
        char words[32];
        std::snprintf(words, sizeof words, "%s %g", limit->at_most ? "<=" : ">=", limit->value);
        figure.limit = words;
        figure.met = limit->at_most ? *value <= limit->value : *value >= limit->value;
    }
    return figures;
}

void print_figures(std::FILE* file, const std::vector<Json>& measurements,
                   const std::vector<Figure>& figures) {
    if (measurements.empty()) return;
    const Json& body = measurements.front();
    std::fprintf(file, "\n%s: %d tetrahedra, %d nodes, %d surface nodes\n",
                 body["body"].get<std::string>().c_str(), body["tetrahedra"].get<int>(),
                 body["nodes"].get<int>(), body["surface_nodes"].get<int>());
    for (const auto& [method, m] : fastest(measurements))
        std::fprintf(file, "    %-35s %10.2f s wall %10.2f s processor\n", method.c_str(),
                     m["seconds"].get<double>(), m["cpu_seconds"].get<double>());
    for (const Figure& figure : figures) {
        std::fprintf(file, "    %-35s %10.3g", figure.name.c_str(), figure.value);
        if (figure.met)
            std::fprintf(file, "   %s: %s", figure.limit.c_str(), *figure.met ? "met" : "NOT MET");
        std::fprintf(file, "\n");
    }
    std::fflush(file);
}

}  // namespace palpate
