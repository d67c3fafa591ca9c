// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/benchmarks/condensation/figures.hpp"

#include <cmath>
#include <functional>
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

struct Limit {
    const char* name;
    std::vector<const char*> methods;  // that must have been measured
    std::function<double(const ByMethod&)> value;
    bool at_most;
    double limit;
    double fewest_nodes, most_nodes;  // surfaces that the limit is meant for
};

std::function<double(const ByMethod&)> value_of(const char* method, const char* key, double scale = 1) {
    return [=](const ByMethod& best) { return scale * best.at(method).at(key).get<double>(); };
}

std::function<double(const ByMethod&)> ratio(const char* above, const char* below, const char* key) {
    return [=](const ByMethod& best) { return value_of(above, key)(best) / value_of(below, key)(best); };
}

double peak_over_block(const ByMethod& best) {
    const Json& exact = best.at("exact");
    return exact.at("peak_bytes").get<double>() / (2 * exact.at("bytes").get<double>());
}

std::vector<Limit> limits() {
    constexpr double any = INFINITY;
    return {
        {"exact / LAPACK, wall",
         {"exact", "lapack"},
         ratio("exact", "lapack", "seconds"),
         true,
         1.6,
         1900,
         5200},
        {"exact / LAPACK, processor",
         {"exact", "lapack"},
         ratio("exact", "lapack", "cpu_seconds"),
         true,
         1.6,
         any,
         any},
        {"peak memory / block in double", {"exact"}, peak_over_block, true, 2.5, 0, any},
        {"CHOLMOD solves / exact",
         {"cholmod", "exact"},
         ratio("cholmod", "exact", "seconds"),
         false,
         3,
         3900,
         any},
        {"iterative as SOFA / exact",
         {"iterative", "exact"},
         ratio("iterative", "exact", "seconds"),
         false,
         200,
         0,
         any},
        {"iterative to 1e-6 / exact",
         {"iterative_loose", "exact"},
         ratio("iterative_loose", "exact", "seconds"),
         false,
         200,
         any,
         any},
        {"residual in double", {"exact"}, value_of("exact", "residual_double"), true, 1e-10, 0, any},
        {"residual as stored", {"exact"}, value_of("exact", "residual_stored"), true, 1e-6, 0, any},
        {"hierarchical, error", {"hierarchical"}, value_of("hierarchical", "error"), true, 1e-3, 0, any},
        {"hierarchical, MB at 5 000 nodes",
         {"hierarchical"},
         value_of("hierarchical", "bytes", 1e-6),
         true,
         50,
         0,
         5200},
        {"hierarchical, MB at 20 000 nodes",
         {"hierarchical"},
         value_of("hierarchical", "bytes", 1e-6),
         true,
         1073.7,
         18000,
         21000},
        {"hierarchical, minutes",
         {"hierarchical"},
         value_of("hierarchical", "seconds", 1.0 / 60),
         true,
         45,
         0,
         21000},
        {"hierarchical, peak memory, GB",
         {"hierarchical"},
         value_of("hierarchical", "peak_bytes", 1e-9),
         true,
         16,
         0,
         21000},
        {"hierarchical, C_cc of 32 nodes, us",
         {"hierarchical"},
         value_of("hierarchical", "block_us"),
         true,
         200,
         0,
         21000},
        {"hierarchical, displacements, ms",
         {"hierarchical"},
         value_of("hierarchical", "displacements_ms"),
         true,
         5,
         0,
         21000},
    };
}

std::string text(const Limit& limit) {
    char number[32];
    std::snprintf(number, sizeof number, "%s %g", limit.at_most ? "<=" : ">=", limit.limit);
    return number;
}

}  // namespace

std::vector<Figure> figures_of(const std::vector<Json>& measurements) {
    std::vector<Figure> figures;
    if (measurements.empty()) return figures;
    const ByMethod best = fastest(measurements);
    const double nodes = measurements.front()["surface_nodes"];
    for (const Limit& limit : limits()) {
        bool measured = true;
        for (const char* method : limit.methods) measured = measured && best.contains(method);
        if (!measured) continue;
        Figure& figure =
            figures.emplace_back(Figure{limit.name, limit.value(best), text(limit), std::nullopt});
        if (nodes >= limit.fewest_nodes && nodes <= limit.most_nodes)
            figure.met = limit.at_most ? figure.value <= limit.limit : figure.value >= limit.limit;
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
    for (const Figure& figure : figures)
        std::fprintf(file, "    %-35s %10.3g   %s%s\n", figure.name.c_str(), figure.value,
                     figure.limit.c_str(),
                     !figure.met   ? ", for information"
                     : *figure.met ? ": met"
                                   : ": NOT MET");
    std::fflush(file);
}

}  // namespace palpate
