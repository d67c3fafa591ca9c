// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/benchmarks/condensation/figures.hpp"

#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string>

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

struct Figure {
    const char* name;
    enum class Limit { at_most, at_least } limit;
    double value;
    double fewest_nodes, most_nodes;  // surfaces that the limit holds for
    std::vector<const char*> methods;
    std::function<double(ByMethod&)> of;
};

double ratio(ByMethod& best, const char* above, const char* below, const char* key) {
    return best[above][key].get<double>() / best[below][key].get<double>();
}

std::vector<Figure> all_figures() {
    constexpr auto at_most = Figure::Limit::at_most, at_least = Figure::Limit::at_least;
    constexpr double any = INFINITY;
    return {
        {"exact / LAPACK, wall",
         at_most,
         1.6,
         1900,
         5200,
         {"exact", "lapack"},
         [](ByMethod& best) { return ratio(best, "exact", "lapack", "seconds"); }},
        {"exact / LAPACK, processor",
         at_most,
         1.6,
         any,
         any,
         {"exact", "lapack"},
         [](ByMethod& best) { return ratio(best, "exact", "lapack", "cpu_seconds"); }},
        {"exact, peak memory / block in double",
         at_most,
         2.5,
         0,
         any,
         {"exact"},
         [](ByMethod& best) {
             const Json& exact = best["exact"];
             return exact["peak_bytes"].get<double>() / (2 * exact["bytes"].get<double>());
         }},
        {"CHOLMOD solves / exact",
         at_least,
         3,
         3900,
         any,
         {"cholmod", "exact"},
         [](ByMethod& best) { return ratio(best, "cholmod", "exact", "seconds"); }},
        {"iterative as SOFA / exact",
         at_least,
         200,
         0,
         any,
         {"iterative", "exact"},
         [](ByMethod& best) { return ratio(best, "iterative", "exact", "seconds"); }},
        {"iterative to 1e-6 / exact",
         at_least,
         200,
         any,
         any,
         {"iterative_loose", "exact"},
         [](ByMethod& best) { return ratio(best, "iterative_loose", "exact", "seconds"); }},
        {"residual in double",
         at_most,
         1e-10,
         0,
         any,
         {"exact"},
         [](ByMethod& best) { return best["exact"]["residual_double"].get<double>(); }},
        {"residual as stored",
         at_most,
         1e-6,
         0,
         any,
         {"exact"},
         [](ByMethod& best) { return best["exact"]["residual_stored"].get<double>(); }},
    };
}

}  // namespace

void print_figures(std::FILE* file, const std::vector<Json>& measurements) {
    if (measurements.empty()) return;
    ByMethod best = fastest(measurements);
    const Json& any = measurements.front();
    const double nodes = any["surface_nodes"];
    std::fprintf(file, "\n%s: %d tetrahedra, %d nodes, %d on the surface to be touched\n",
                 any["body"].get<std::string>().c_str(), any["tetrahedra"].get<int>(),
                 any["nodes"].get<int>(), any["surface_nodes"].get<int>());
    for (auto& [name, m] : best)
        std::fprintf(file, "    %-38s %10.2f s wall, %10.2f s processor\n", name.c_str(),
                     m["seconds"].get<double>(), m["cpu_seconds"].get<double>());
    for (const Figure& figure : all_figures()) {
        bool measured = true;
        for (const char* method : figure.methods) measured = measured && best.contains(method);
        if (!measured) continue;
        const double value = figure.of(best);
        std::fprintf(file, "    %-38s %10.3g", figure.name, value);
        const bool at_most = figure.limit == Figure::Limit::at_most;
        if (nodes >= figure.fewest_nodes && nodes <= figure.most_nodes)
            std::fprintf(file, "   %s %g: %s", at_most ? "<=" : ">=", figure.value,
                         (at_most ? value <= figure.value : value >= figure.value) ? "met" : "NOT MET");
        std::fprintf(file, "\n");
    }
    std::fflush(file);
}

}  // namespace palpate
