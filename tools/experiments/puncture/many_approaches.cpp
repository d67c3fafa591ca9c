// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/puncture/many_approaches.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <random>
#include <thread>

#include "tools/experiments/puncture/approach_run.hpp"
#include "tools/experiments/puncture/puncture_groups.hpp"
#include "tools/experiments/rigid_case.hpp"
#include "tools/experiments/statistics.hpp"
#include "tools/meshing/files/mesh_files.hpp"

namespace palpate::experiments {
namespace {

using namespace haptics;

constexpr std::int64_t approaches_by_default = 10000;
constexpr double slowest = 50, fastest = 1000;  // mm/s

constexpr std::string_view approaches_method =
    "# Approaches with `continuous`\n\nThe hand and the rule of `palpate bench puncture`, at random places "
    "of "
    "each surface as that draws them, at {:g} to {:g} mm/s. Every tick of every approach the tool itself, as "
    "drawn, is tested for overlap with the surface and for being beneath it, and its straight way since the "
    "tick before for going through: as it does where a fast tool slides round an edge between two ticks. The "
    "hold may be lost without any of it: a tip without friction goes round an edge or into an opening.\n\n"
    "| surface | triangles | approaches | tip just before the surface, median / most, mm/s | tool overlapped "
    "or beneath | straight way through | hold lost | of these any of both | least aside of these, mm | "
    "pulled |\n"
    "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";

struct Tally {
    std::int64_t inside = 0, crossed = 0, lost = 0, lost_through = 0, pulled = 0;
    double least_aside = Approach::stroke;  // mm, where the hold was lost
    std::vector<double> tip_speeds;         // mm/s
};

// The models of one surface, one for each thread.
std::vector<std::unique_ptr<HapticModel>> make_models(const Case& bone, const devices::DeviceModel& device,
                                                      int threads) {
    const devices::DynamicDevice coupled(device, {}, devices::HandPath({{0, Eigen::Vector3d::Zero()}}));
    const DeviceLimits limits = coupled.limits();
    std::vector<std::unique_ptr<HapticModel>> models;
    for (int i = 0; i < threads; ++i) {
        models.push_back(std::make_unique<HapticModel>(bone, schemes[continuous_scheme]));
        models.back()->couple_to({&limits, 1});
    }
    return models;
}

std::vector<Approach> draw(const Case& bone, const HapticModel& model, std::int64_t count,
                           std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0, 1), speed(slowest, fastest);
    std::vector<Approach> approaches;
    for (Place& place : draw_places(bone.rigid_bodies[0].surface, model.surface(0),
                                    approach_settings.tool_radius, static_cast<std::size_t>(count), random)) {
        const double hand_speed = speed(random);
        approaches.push_back({std::move(place), hand_speed, unit(random)});
    }
    return approaches;
}

void add(Tally& tally, const Outcome& outcome, double coupling) {
    const bool lost = is_puncture(outcome, coupling);
    tally.lost += lost;
    tally.lost_through += lost && (outcome.tool_in_surface || outcome.way_crossed);
    tally.inside += outcome.tool_in_surface;
    tally.crossed += outcome.way_crossed;
    tally.pulled += is_pulled(outcome);
    if (lost) tally.least_aside = std::min(tally.least_aside, outcome.aside);
    tally.tip_speeds.push_back(outcome.speed);
}

// Threads share out each batch; what comes out does not depend on their number.
Tally run(std::vector<std::unique_ptr<HapticModel>>& models, const devices::DeviceModel& device,
          const std::vector<Approach>& approaches, const std::function<void(double)>& progress) {
    constexpr std::size_t batch = 1000;
    Tally tally;
    std::vector<Outcome> outcomes;
    for (std::size_t first = 0; first < approaches.size(); first += batch) {
        progress(static_cast<double>(first) / static_cast<double>(approaches.size()));
        outcomes.resize(std::min(batch, approaches.size() - first));
        {
            std::vector<std::jthread> threads;
            for (std::size_t worker = 0; worker < models.size(); ++worker)
                threads.emplace_back([&, worker] {
                    for (std::size_t i = worker; i < outcomes.size(); i += models.size())
                        outcomes[i] = run_approach(*models[worker], device, approaches[first + i], true);
                });
        }
        for (const Outcome& outcome : outcomes) add(tally, outcome, models[0]->coupling());
    }
    return tally;
}

}  // namespace

Findings many_approaches(const Options& options, cli::Session& session) {
    if (options.surfaces.empty())
        throw UsageError({"--surface", "not given", "triangles of a closed surface (.vtp), one or more", ""});
    const std::int64_t count = options.approaches > 0 ? options.approaches : approaches_by_default;
    const devices::DeviceModel& device = devices::find_device_model("desktop");
    Findings findings;
    findings.table = fmt::format(approaches_method, slowest, fastest);
    for (const std::filesystem::path& file : options.surfaces) {
        const std::string name = file.stem().string();
        session.progress.step(name, 0);
        const Case bone = rigid_case(name, meshing::read_surface(file), approach_settings);
        auto models = make_models(bone, device, session.threads);
        std::mt19937_64 random(options.seed);
        const auto approaches = draw(bone, *models[0], count, random);
        const Tally tally =
            run(models, device, approaches, [&](double fraction) { session.progress.step(name, fraction); });
        const std::size_t triangles = bone.rigid_bodies[0].surface.triangles.size();
        const double median = quantile(tally.tip_speeds, 0.5), most = quantile(tally.tip_speeds, 1);
        findings.table += fmt::format(
            "| {} | {} | {} | {:.0f} / {:.0f} | **{}** | {} | {} | **{}** | {} | {} |\n", name, triangles,
            count, median, most, tally.inside, tally.crossed, tally.lost, tally.lost_through,
            tally.lost > 0 ? fmt::format("{:.1f}", tally.least_aside) : "–", tally.pulled);
        findings.result["surfaces"].push_back({{"surface", name},
                                               {"triangles", triangles},
                                               {"approaches", count},
                                               {"tool_in_surface", tally.inside},
                                               {"straight_way_through", tally.crossed},
                                               {"punctures", tally.lost},
                                               {"punctures_through_surface", tally.lost_through},
                                               {"pulled", tally.pulled},
                                               {"tip_speed_max_mm_s", most}});
    }
    session.progress.finish();
    return findings;
}

}  // namespace palpate::experiments
