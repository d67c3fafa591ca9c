// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/init/questions.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <ranges>
#include <spdlog/spdlog.h>

#include "formats/model/errors.hpp"
#include "tools/draft/anatomy.hpp"
#include "tools/draft/scan_draft.hpp"
#include "tools/imaging/faces/face.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"

namespace palpate::commands {

void ask_series(InitRequest& request, cli::Questions& questions) {
    if (!questions.asks() || !request.series.empty() || !std::filesystem::is_directory(request.input)) return;
    const std::vector<imaging::SeriesSummary> all = imaging::list_series(request.input);
    if (all.size() < 2) return;
    std::string list;
    const imaging::SeriesSummary* most = &all.front();
    for (const imaging::SeriesSummary& series : all) {
        list += fmt::format("  {}: {} '{}', {} x {} x {} voxels\n", series.number, series.modality,
                            series.description, series.size[0], series.size[1], series.size[2]);
        if (!series.localizer && (most->localizer || series.size[2] > most->size[2])) most = &series;
    }
    request.series = questions.ask(list + "Which series?", most->number, [&](const std::string& answer) {
        if (std::ranges::find(all, answer, &imaging::SeriesSummary::number) == all.end())
            throw UsageError({"--series", answer, "the number of one of the list", ""});
    });
}

void ask_organ(InitRequest& request, const LabelMap& map, cli::Questions& questions) {
    if (!questions.asks() || !request.organ.empty()) return;
    constexpr std::size_t shown = 12;
    const auto organs = draft::organs_in(map, wishes_of(request).approach);
    std::string list;
    for (const draft::OrganChoice& organ : organs | std::views::take(shown))
        list += fmt::format("  {}, {:.0f} ml{}\n", organ.name, organ.volume_ml,
                            organ.tissue_known ? "" : ", of no known tissue");
    request.organ = questions.ask(
        list + "Which structure gives way under the tool?", organs.empty() ? "" : organs.front().name,
        [&](const std::string& answer) { require_label(map, answer, request.input.filename().string()); });
}

void ask_organ(InitRequest& request, const Volume& volume, bool ct, cli::Questions& questions) {
    if (!request.organ.empty()) return;
    if (!ct && !questions.asks())
        throw UsageError({"--organ", "none given, and nothing can be proposed where values are no HU", "",
                          "say what is to be found, for example --organ brain"});
    const char* proposal = !ct ? "" : imaging::shows_head(volume) ? "nasopharynx" : "liver";
    request.organ = questions.ask("What gives way under the tool?", proposal, check_name);
    if (!questions.asks()) spdlog::info("{} is looked for; --organ says otherwise", request.organ);
}

void ask_scale(InitRequest& request, const Volume& volume, cli::Questions& questions) {
    if (request.scale || imaging::is_ct(volume)) return;
    const auto found = imaging::scale_by_air_and_soft_tissue(volume);
    if (!found) return;
    const std::string said = "values are no HU; by air and soft tissue " + imaging::text_of(*found);
    const std::string answer = questions.ask(
        "The " + said + ". Take that for a CT (yes, or no: it is none)?", "yes", [](const std::string& text) {
            if (text != "yes" && text != "no")
                throw UsageError({"answer", "'" + text + "'", "yes or no", ""});
        });
    if (answer != "yes") return;
    if (!questions.asks()) spdlog::warn("{}: taken for a CT; --scale and --offset say otherwise", said);
    // As the case file has them.
    request.scale = std::stod(fmt::format("{:.4g}", found->scale));
    request.offset = std::stod(fmt::format("{:.4g}", found->offset));
    request.scale_is_guessed = true;
}

void ask_name(InitRequest& request, cli::Questions& questions) {
    if (request.organ.empty())
        request.organ = questions.ask("What is it? A known name gives its tissue",
                                      request.input.stem().string(), check_name);
}

void ask_approach(InitRequest& request, cli::Questions& questions) {
    if (!questions.asks() || !request.approach.empty()) return;
    request.approach = questions.ask(
        "Which side does the tool come from (anterior, posterior, left, right, superior, inferior)?",
        "anterior", [](const std::string& answer) { draft::direction_of(answer, "--approach"); });
}

void ask_size(InitRequest& request, cli::Questions& questions) {
    if (!questions.asks() || request.size_mib > 0 || request.contact_nodes > 0) return;
    static constexpr double least = 1, most = 100'000, usual = 140;  // MiB, of some 2 000 nodes
    request.size_mib = std::stod(questions.ask(
        "What may the compliance, most of the asset, take, MiB? Half of it is a mesh a fifth coarser",
        fmt::format("{}", usual), [](const std::string& answer) {
            char* end = nullptr;
            const double size = std::strtod(answer.c_str(), &end);
            if (end == answer.c_str() || *end != '\0' || !(size >= least && size <= most))
                throw UsageError({"size", answer, fmt::format("{} to {} MiB", least, most), ""});
        }));
}

void ask_seed(InitRequest& request, const draft::ScanRecipes& recipes, cli::Questions& questions) {
    if (!questions.asks() || std::getenv("DISPLAY") != nullptr) return;
    request.seeds.push_back(
        questions.ask(fmt::format("A point x,y,z in {} (LPS, mm)", recipes.where), "",
                      [](const std::string& answer) { draft::check_point(answer, "--seed"); }));
}

}  // namespace palpate::commands
