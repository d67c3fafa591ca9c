// SPDX-License-Identifier: GPL-3.0-or-later
// palpate seeds: a window in which a person clicks into structures and sees them grow.
#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "tools/cli/command.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/recipes/segmentation.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"
#include "tools/imaging/voxels/seed_statistics.hpp"
#include "tools/seeds/seed_window.hpp"

namespace {

using namespace palpate;
using namespace palpate::imaging;
using namespace palpate::seeds;
using nlohmann::ordered_json;

// "liver.mrk.json" holds seeds of the liver.
std::string structure_of(const std::filesystem::path& output) {
    const std::string name = output.filename().string();
    return name.substr(0, name.find('.'));
}

void check_label(const std::string& label) {
    if (label.empty()) throw UsageError({"--label", "is empty", "a name", "for example 'left kidney'"});
}

GreyScale greys_of(const Volume& volume, const std::vector<double>& chosen) {
    GreyScale greys = grey_scale(volume);
    if (chosen.empty()) return greys;
    if (chosen.size() != 2 || chosen[0] <= 0)
        throw UsageError({"--window-level", fmt::format("{}", fmt::join(chosen, ",")),
                          "width,level, the width above 0", "for example --window-level 400,40"});
    greys.presets.insert(greys.presets.begin(), {"your own", chosen[0], chosen[1] + greys.offset});
    return greys;
}

ordered_json describe(const SeedWindowResult& result, const std::filesystem::path& output, bool written) {
    ordered_json seeds = ordered_json::array(), regions = ordered_json::array();
    for (const Seed& seed : result.state.seeds)
        seeds.push_back({{"label", seed.label}, {"position_mm", {seed.p_P[0], seed.p_P[1], seed.p_P[2]}}});
    if (result.growth)
        for (std::size_t n = 0; n < result.growth->map.names.size(); ++n)
            regions.push_back(
                {{"name", result.growth->map.names[n].name}, {"volume_ml", result.growth->volume_ml[n]}});
    ordered_json description{{"saved", !unsaved(result.state)},
                             {"seeds", seeds},
                             {"regions", regions},
                             {"growths", result.growths},
                             {"last_growth_seconds", result.growth ? result.growth->seconds : 0.0},
                             {"longest_growth_seconds", result.longest_growth}};
    if (written) description["output"] = output.string();
    return description;
}

// What the command line asks for.
struct SeedsRequest {
    std::filesystem::path volume, seeds, output = "seed.mrk.json";
    std::vector<std::string> labels, structures;
    std::vector<double> window_level;
    std::string series;
    imaging::HounsfieldScale to_hounsfield;
};

void declare_seeds(cli::Command& command, SeedsRequest& request) {
    command.input("volume", request.volume, "volume, any format that 'palpate import' reads").required();
    command.output("-o,--output", request.output, "seeds for 3D Slicer, 'segment' and case files (.mrk.json)")
        .shown_default(request.output.string());
    command
        .option("--label", request.labels,
                "a structure to place seeds in, up to nine [default: the output's name up to its first dot]")
        .one_value_each();  // the next word may be the volume
    command
        .option(
            "--structure", request.structures,
            "'NAME: recipe=...' as for 'segment', whose own result is shown in place of a preview; repeat "
            "for more")
        .one_value_each();
    command.option("--series", request.series,
                   "of a DICOM folder with several, as 'palpate import' takes it");
    command
        .option("--scale", request.to_hounsfield.scale,
                "of a CT whose values are no HU, as 'palpate import' takes it")
        .positive();
    command.option("--offset", request.to_hounsfield.offset, "see --scale", "HU");
    command.input("--seeds", request.seeds, "seeds to start from (.mrk.json, .fcsv)");
    command
        .option("--window-level", request.window_level,
                "WIDTH,LEVEL of the grey window at first [default: 400,40 for a CT, else the 1st to 99th "
                "percentile]",
                "HU, or the volume's own values")
        .one_value_each(',');
}

// The label of each structure that seeds can be given to, in order.
std::vector<std::string> seeded_labels(const std::vector<StructureRecipe>& structures) {
    std::vector<std::string> labels;
    for (const StructureRecipe& structure : structures)
        if (takes_seeds(structure)) labels.push_back(structure.name);
    if (labels.empty())
        throw UsageError({"--structure", "no recipe of them takes seeds",
                          "one that does, such as liver or grow-from-seeds", "see 'palpate segment --help'"});
    return labels;
}

ordered_json run_seeds(SeedsRequest request, cli::Session& session) {
    const std::filesystem::path& output = request.output;
    if (!output.filename().string().ends_with(".mrk.json"))
        throw UsageError({"--output", output.string(), "a name that ends in .mrk.json", ""});
    for (const std::string& label : request.labels) check_label(label);
    std::vector<StructureRecipe> structures;
    for (const std::string& text : request.structures) structures.push_back(parse_structure(text));
    if (!structures.empty()) {
        if (!request.labels.empty())
            throw UsageError({"--label", "given beside --structure", "one of them",
                              "a structure has its label in its name"});
        request.labels = seeded_labels(structures);
    }
    session.stage(output);  // refuses now what could not be written after the clicking
    session.progress.step("reading", 0);
    set_imaging_threads(session.threads);
    ReadOptions options;
    options.series = request.series;
    Volume volume = read_volume(
        request.volume, [](std::string_view text) { spdlog::warn("{}", text); }, options);
    rescale(volume, request.to_hounsfield);
    const std::vector<Seed> seeds = request.seeds.empty() ? std::vector<Seed>{} : read_seeds(request.seeds);
    for (const Seed& seed : seeds)
        voxel_of_seed(volume.grid, seed.p_P, request.seeds.string() + ", '" + seed.label + "'");
    if (request.labels.empty() && seeds.empty()) request.labels.push_back(structure_of(output));
    SeedWindowSettings settings{
        .title = request.volume.filename().string(),
        .state = start_state(volume.grid, request.labels, seeds),
        .greys = greys_of(volume, request.window_level),
        .save = {},
        .growing = structures.empty() ? preview_growing(volume) : recipe_growing(volume, structures)};
    bool written = false;
    settings.save = [&](std::span<const Seed> placed) {
        cli::StagedFile staged(output, session.force || written);
        try {
            write_seeds(staged.path(), placed);
        } catch (const SystemFailure&) {  // which has the temporary path
            throw SystemFailure(
                {output.string(), "could not be written", "", "check free space and permissions"});
        }
        staged.commit();
        written = true;
        return output.string();
    };
    session.progress.finish();
    const SeedWindowResult result = run_seed_window(volume, settings);
    if (unsaved(result.state)) spdlog::warn("closed without saving the seeds as they were");
    return describe(result, output, written);
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "seeds",
         .summary =
             "Opens a window to click seeds into structures, and saves them for 'segment' and case files",
         .examples = {"palpate seeds volume.nrrd -o liver.mrk.json",
                      "palpate seeds volume.nrrd --label liver --label tumour -o organs.mrk.json",
                      "palpate seeds ct.nrrd --structure 'liver: recipe=liver' -o liver.mrk.json",
                      "palpate segment --volume volume.nrrd --structure 'liver: recipe=grow-from-seeds "
                      "seeds_file=liver.mrk.json' -o labels.seg.nrrd"},
         .notes =
             "Three linked slices along the volume's own axes, patient's right at the left. A left click "
             "places a seed of\nthe active label; the region that grows from the seeds is drawn within a "
             "second, in preview: at coarser voxels\nthan 'segment' uses. Seeds of 'background' (key 0) stop "
             "it where it leaks. With --structure it is what\n'segment' will make, after some seconds, or "
             "why "
             "it will refuse.\n\n"
             "Left click places a seed, right click removes the nearest, X or Delete the last, U undoes.\n"
             "Shift and left button, or the middle button, move the crosshair only. The wheel, arrow up and "
             "down scroll the\nslice under the pointer; forward is away from the viewer. 1 ... 9 choose a "
             "label, 0 the background.\n+ and - change the grey window, a drag with the right button its "
             "width (sideways) and level (up and down).\nZ zooms about the crosshair, H hides the help, S "
             "saves, Q or Escape quits, a second time where seeds are not\nsaved. The window needs an X "
             "display; elsewhere place points in 3D Slicer, whose files are read as well."});
    SeedsRequest request;
    declare_seeds(command, request);
    return command.run(argc, argv, [&](cli::Session& session) { return run_seeds(request, session); });
}
