// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/recipes/recipe.hpp"
#include "tools/imaging/recipes/recipe_json.hpp"
#include "tools/imaging/recipes/segmentation.hpp"
#include "tools/imaging/voxels/label_statistics.hpp"
#include "tools/report/pictures/preview.hpp"
#include "tools/stages/image.hpp"
#include "tools/stages/requests/segment_request.hpp"

namespace {

using namespace palpate;
using namespace palpate::imaging;
using nlohmann::json;
using nlohmann::ordered_json;

StructureRecipe recipe_of(const stages::StructureRequest& structure) {
    return structure.words.empty()
               ? structure_recipe(structure.name, structure.recipe, structure.parameters, structure.name)
               : parse_structure(structure.words);
}

std::string recipe_help() {
    std::vector<std::string> inside, cleaning;
    for (const Recipe& recipe : recipes())
        if (find_parameter(recipe, "inside")) inside.push_back(recipe.name);
    for (const RecipeParameter& step : cleaning_parameters()) cleaning.push_back(step.name);
    std::string text = fmt::format(
        "A structure takes background only, in the order given; one with 'inside' ({}) takes voxels\n"
        "of the structure that it names. Points are LPS in mm: x,y,z and several as x,y,z;x,y,z (3D Slicer\n"
        "shows RAS: negate x and y). Cleaning steps apply in the order written, those left at a default\n"
        "before them: {}.\n"
        "A recipe file is a JSON array of {{\"name\", \"recipe\", \"parameters\"}}; a path with a blank can "
        "be given\n"
        "there only.\n\nRecipes and their parameters:\n",
        fmt::join(inside, ", "), fmt::join(cleaning, ", "));
    for (const Recipe& recipe : recipes()) {
        text += fmt::format("  {}: {}\n", recipe.name, recipe.meaning);
        for (const RecipeParameter& parameter : recipe.parameters) {
            text += fmt::format("    {:<17} {}", parameter.name, parameter.meaning);
            if (!parameter.unit.empty()) text += " [" + parameter.unit + "]";
            if (!parameter.default_value.empty()) text += " (default " + parameter.default_value + ")";
            text += "\n";
        }
    }
    return text;
}

ordered_json describe(const LabelMap& map, const std::vector<std::string>& notes) {
    ordered_json labels = ordered_json::array();
    for (const LabelStatistics& label : label_statistics(map)) labels.push_back(stages::to_json(label));
    return {{"labels", labels}, {"notes", notes}};
}

std::vector<StructureRecipe> structures_of(const stages::SegmentRequest& request) {
    std::vector<StructureRecipe> structures;
    if (!request.recipes.empty()) structures = read_recipe_file(request.recipes);
    for (const stages::StructureRequest& structure : request.structures)
        structures.push_back(recipe_of(structure));
    if (structures.empty()) throw UsageError({"--structure", "none given", "at least one, or --recipes", ""});
    return structures;
}

ordered_json run_segment(const stages::SegmentRequest& request, cli::Session& session) {
    const std::vector<StructureRecipe> structures = structures_of(request);
    if (request.volume.empty() && request.labels.empty())
        throw UsageError({"--volume", "not given, nor --labels", "at least one of them", ""});
    require_ending(request.output, ".seg.nrrd");
    set_imaging_threads(session.threads);
    auto staged = session.stage(request.output);
    std::optional<cli::StagedFile> preview;
    if (!request.preview.empty()) preview.emplace(request.preview, session.force);
    session.progress.step("reading", 0);
    std::vector<std::string> notes;
    const NoteSink note = [&](std::string_view text) {
        spdlog::warn("{}", text);
        notes.emplace_back(text);
    };
    std::optional<Volume> volume;
    std::optional<LabelMap> prior;
    if (!request.volume.empty()) volume = read_volume(request.volume, note);
    if (!request.labels.empty()) prior = read_label_map(request.labels, note);
    const LabelMap map = segment(
        volume ? &*volume : nullptr, prior ? &*prior : nullptr, structures,
        [&](std::string_view name, double fraction) {
            session.progress.step(std::string("segmenting ") + std::string(name), 0.1 + 0.8 * fraction);
        },
        note);
    session.progress.step("writing", 0.9);
    write_label_map(staged.path(), map);
    if (preview) {
        preview->write_text(report::label_preview_png(map, volume ? &*volume : nullptr));
        preview->commit();
        spdlog::info("a picture of the structures is in {}", request.preview.string());
    }
    staged.commit();
    return describe(map, notes);
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "segment",
         .summary = "Makes a label map of named structures from a volume, by recipes",
         .examples =
             {"palpate segment --volume head.nrrd --structure 'skull: recipe=bone threshold_hu=226' -o "
              "skull.seg.nrrd",
              "palpate segment --volume volume.nrrd --structure 'liver: recipe=liver "
              "seeds=-30,-8,-4;-2,-14,-8 lesion_seeds_mm=-22,-10,4' "
              "--structure 'tumour: recipe=tumour inside=liver seeds_file=tumour.mrk.json' -o "
              "labels.seg.nrrd",
              "palpate segment --labels prior.seg.nrrd --structure 'liver: recipe=import' --structure "
              "'tumour: recipe=sphere inside=liver center_mm=-4,-14,-6 radius_mm=8' -o labels.seg.nrrd"},
         .notes = recipe_help()});
    stages::SegmentRequest request;
    declare(command, request);
    return command.run(argc, argv, [&](cli::Session& session) { return run_segment(request, session); });
}
