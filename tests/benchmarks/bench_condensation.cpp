// SPDX-License-Identifier: GPL-3.0-or-later
// Measures condensation against LAPACK, CHOLMOD and conjugate gradients, in one run and with equal threads.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cblas.h>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>

#include "formats/model/errors.hpp"
#include "tests/benchmarks/condensation/figures.hpp"
#include "tests/benchmarks/condensation/methods.hpp"
#include "tools/experiments/ellipsoid.hpp"
#include "tools/fem/condensation/condensation_plan.hpp"
#include "tools/fem/solvers/dense_kernels.hpp"
#include "tools/meshing/files/mesh_files.hpp"

namespace palpate {
namespace {

using namespace fem;

constexpr const char* schema = "palpate.bench.condensation.1";

struct Options {
    std::vector<std::filesystem::path> bodies;
    std::vector<std::string> methods;
    std::string fixed;  // a rule, or empty for the ellipsoid's
    std::filesystem::path json;
    int threads = 2;
    int repeats = 3;
};

const Method& method_named(const std::string& name) {
    const auto& methods = condensation_methods();
    const auto found = std::ranges::find(methods, name, &Method::name);
    if (found != methods.end()) return *found;
    std::string known;
    for (const Method& method : methods) known += (known.empty() ? "" : ", ") + method.name;
    throw UsageError({"method '" + name + "'", "unknown", known, ""});
}

Json heading(const std::filesystem::path& path, const DeformableBody& body) {
    return {{"schema", schema},
            {"body", path.stem().string()},
            {"tetrahedra", body.mesh.tetrahedra.size()},
            {"nodes", body.mesh.rest_positions.size()},
            {"surface_nodes", body.contact_nodes.size()},
            {"blas_kernels", openblas_get_corename()}};
}

std::vector<Json> measure_body(const Options& options, const std::filesystem::path& path,
                               std::ofstream& json) {
    const NodeRule rule =
        options.fixed.empty() ? experiments::ellipsoid_support : parse_node_rule("--fixed", options.fixed);
    const DeformableBody body = experiments::held_body(meshing::read_tetrahedra(path), rule);
    const auto dofs = static_cast<double>(3 * body.contact_nodes.size());
    std::vector<Json> measurements;
    for (int repeat = 0; repeat < options.repeats; ++repeat)
        for (const std::string& name : options.methods) {
            const Method& method = method_named(name);
            if (repeat > 0 && !method.repeatable) continue;
            if (method.memory(dofs) > available_memory()) {
                std::fprintf(stderr, "%s: %s left out: it needs about %.1f GB, and %.1f are free\n",
                             path.stem().c_str(), name.c_str(), 1e-9 * method.memory(dofs),
                             1e-9 * available_memory());
                continue;
            }
            std::fprintf(stderr, "%s: %s\n", path.stem().c_str(), name.c_str());
            Json line = heading(path, body);
            line["method"] = name;
            line["threads"] = options.threads;
            line.update(in_child([&] { return method.measure(body, options.threads); }));
            if (json.is_open()) json << line << std::endl;
            measurements.push_back(std::move(line));
        }
    return measurements;
}

void bench(const Options& options) {
    for (const std::string& name : options.methods) method_named(name);
    std::ofstream json;
    if (!options.json.empty()) json.open(options.json);
    if (!options.json.empty() && !json)
        throw SystemFailure({options.json.string(), "cannot be written", "", ""});
    for (const auto& path : options.bodies) {
        const std::vector<Json> measurements = measure_body(options, path, json);
        const std::vector<Figure> figures = figures_of(measurements);
        print_figures(stdout, measurements, figures);
        if (!json.is_open()) continue;
        for (const Figure& figure : figures) {
            Json line = {{"schema", schema},
                         {"body", measurements.front()["body"]},
                         {"surface_nodes", measurements.front()["surface_nodes"]},
                         {"figure", figure.name},
                         {"value", figure.value},
                         {"limit", figure.limit}};
            if (figure.met) line["met"] = *figure.met;
            json << line << std::endl;
        }
    }
}

int run(int argc, char** argv) {
    CLI::App app("Measures condensation against LAPACK, CHOLMOD and conjugate gradients.");
    Options options;
    for (const Method& method : condensation_methods()) options.methods.push_back(method.name);
    app.add_option("--bodies", options.bodies, "tetrahedra (.vtu), as condensation_bodies makes them")
        ->required()
        ->check(CLI::ExistingFile);
    app.add_option("--methods", options.methods, "what is measured")->capture_default_str();
    app.add_option("--fixed", options.fixed,
                   "rule that holds nodes, as palpate condense --fixed [default: the ellipsoid's top, beyond "
                   "plane:0,0,42,0,0,1 mm]");
    app.add_option("--threads", options.threads, "threads of every method")->capture_default_str();
    app.add_option("--repeats", options.repeats,
                   "measurements of the short methods, by turns; the fastest counts")
        ->capture_default_str();
    app.add_option("--json", options.json, "file that gets a line of JSON a measurement");
    CLI11_PARSE(app, argc, argv);
    bench(options);
    return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) try {
    palpate::fem::restart_with_fitting_kernels(argv);
    return palpate::run(argc, argv);
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_condensation: %s\n", error.what());
    return 1;
}
