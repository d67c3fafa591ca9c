// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdio>
#include <fmt/format.h>

#include "tools/experiments/experiments.hpp"
#include "tools/experiments/faults.hpp"
#include "tools/experiments/puncture/many_approaches.hpp"
#include "tools/experiments/puncture/puncture.hpp"
#include "tools/experiments/realtime.hpp"
#include "tools/experiments/sixdof/sixdof.hpp"
#include "tools/experiments/stability/passivity.hpp"
#include "tools/experiments/stability/split.hpp"
#include "tools/experiments/stability/stability.hpp"
#include "tools/experiments/tick/tick.hpp"

namespace palpate::experiments {
namespace {

const std::vector<Experiment> experiments{
    // name, what it finds out, function
    {"approaches", "whether any of many fast approaches gets a tool through a surface with `continuous`",
     many_approaches},
    {"faults", "a virtual day of pushing while devices, servo, window and asset fail at random", faults},
    {"passivity", "the stiffest wall that the closed loop bears, against 2b/T", passivity},
    {"puncture",
     "how often a tool is pushed through a bone, by scheme; the published tables 1, 2 and figures 6, 8",
     puncture},
    {"realtime", "ten minutes against the clock beside four busy processes, with and without priority",
     realtime},
    {"sixdof", "whole tools that turn, five ways: ticks, drift, fast approaches; FCL and Bullet judge",
     sixdof},
    {"split", "two deformable bodies: the published split by force ratio against exact contact", split},
    {"stability", "jumps, pulls, roughness and energy of force by scheme, and 10 minutes at random",
     stability},
    {"tick", "what a tick takes, by scheme, body and contacts, alone and with every core busy", tick},
};

const Experiment& find_experiment(const std::string& name) {
    const auto found = std::ranges::find(experiments, name, &Experiment::name);
    if (found != experiments.end()) return *found;
    std::string names;
    for (const Experiment& experiment : experiments)
        names += (names.empty() ? "" : ", ") + std::string(experiment.name);
    throw UsageError({"experiment", name, names, ""});
}

nlohmann::ordered_json run(const std::string& name, const Options& options, cli::Session& session) {
    const Experiment& experiment = find_experiment(name);
    if (!(options.seconds >= 0))
        throw UsageError({"--seconds", std::to_string(options.seconds), "0 or more", ""});
    if (options.approaches < 0)
        throw UsageError({"--approaches", std::to_string(options.approaches), "0 or more", ""});
    cli::require_folder_target(options.output);
    std::filesystem::create_directories(options.output);
    cli::StagedFile table = session.stage(options.output / (name + ".md"));
    Findings findings = experiment.run(options, session);
    for (const auto& [picture, svg] : findings.pictures)
        cli::write_text_file(options.output / (picture + ".svg"), svg, session.force);
    table.write_text(findings.table);
    table.commit();
    findings.result["experiment"] = name;
    if (!session.quiet) std::fputs(findings.table.c_str(), stderr);
    return findings.result;
}

std::string notes() {
    std::string text = "Experiments:";
    for (const Experiment& experiment : experiments)
        text += fmt::format("\n  {:<10} {}", experiment.name, experiment.summary);
    return text;
}

}  // namespace
}  // namespace palpate::experiments

int main(int argc, char** argv) {
    using namespace palpate;
    cli::Command command(
        {.name = "bench",
         .summary = "Runs an experiment on contact and force: a table, pictures and JSON",
         .examples = {"palpate bench puncture --surface skull.vtp -o results",
                      "palpate bench stability --case nasopharynx.vtkhdf --case liver.vtkhdf "
                      "--json stability.json"},
         .notes = experiments::notes()});
    std::string name;
    experiments::Options options;
    command.option("experiment", name, "which one").required();
    command.input("--surface", options.surfaces, "triangles of a bone (.vtp), LPS mm");
    command.input("--case", options.cases, "assets (.vtkhdf)");
    command.input("--instrument", options.tools,
                  "closed surfaces of instruments (.stl), mm: tip at 0, shaft along z");
    command.input("--path", options.path, "hand path: rows 'x y z' (mm), one per millisecond");
    command.output("-o,--output", options.output, "folder for the table (.md) and the pictures (.svg)");
    command.option("--seed", options.seed, "of everything random");
    command.option("--seconds", options.seconds, "how long; 0 is the experiment's own", "s");
    command.option("--scheme", options.schemes,
                   "ways to feel an instrument, for sixdof; all where none is given");
    command.option("--approaches", options.approaches, "how many to each surface; 0 is the experiment's own");
    return command.run(argc, argv,
                       [&](cli::Session& session) { return experiments::run(name, options, session); });
}
