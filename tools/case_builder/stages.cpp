// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/stages.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <span>

#include "formats/model/errors.hpp"
#include "tools/case_builder/provenance.hpp"
#include "tools/cli/items.hpp"
#include "tools/stages/requests/pack_request.hpp"
#include "tools/stages/requests/report_request.hpp"
#include "tools/stages/requests/segment_request.hpp"

namespace palpate::case_builder {
namespace {

using Json = nlohmann::ordered_json;

bool is_nifti(const std::filesystem::path& input) {
    std::string name = input.filename().string();
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
    return name.ends_with(".nii") || name.ends_with(".nii.gz");
}

Stage import_stage(const std::string& name, stages::ImportRequest request, const std::filesystem::path& input,
                   const std::filesystem::path& output) {
    request.input = input;
    request.output = output;
    if (!is_nifti(input)) request.nifti_frame.clear();  // a case names one frame for both inputs
    return {name, "import", cli::to_request(request), {input}, {output}};
}

Stage import_labels_stage(const CaseFile& case_file, const std::filesystem::path& output) {
    stages::ImportRequest request = case_file.labels_import;
    request.labels = true;
    Stage stage = import_stage("import labels", request, *case_file.labels, output);
    if (case_file.label_table) stage.inputs.push_back(*case_file.label_table);
    return stage;
}

Stage segment_stage(const CaseFile& case_file, const std::filesystem::path& parts) {
    stages::SegmentRequest request;
    request.output = parts / "labels.seg.nrrd";
    Stage stage{"segment", "segment", {}, {}, {request.output}};
    for (const StructureSpec& structure : case_file.structures) {
        request.structures.push_back(
            structure_request(structure, "", [](const auto& file) { return file.string(); }));
        for (const auto& [key, file] : structure.files) stage.inputs.push_back(file);
    }
    if (case_file.volume) stage.inputs.push_back(request.volume = parts / "volume.nrrd");
    if (case_file.labels) stage.inputs.push_back(request.labels = parts / "prior.seg.nrrd");
    stage.request = cli::to_request(request);
    return stage;
}

Stage surface_stage(const RigidSpec& body, const std::filesystem::path& parts) {
    stages::SurfaceRequest request = body.surface;
    request.output = parts / (body.name + ".vtp");
    Stage stage{"surface " + body.name, "surface", {}, {}, {request.output}};
    if (request.surface_file.empty())
        stage.inputs.push_back(request.labels = parts / "labels.seg.nrrd");
    else
        stage.inputs.push_back(request.surface_file);
    if (request.isovalue) stage.inputs.push_back(request.volume = parts / "volume.nrrd");
    stage.request = cli::to_request(request);
    return stage;
}

// Of an imported mesh the regions get their labels' names, and its surface its neighbours if there are
// labels.
Stage mesh_stage(const DeformableSpec& body, const CaseFile& case_file, const std::filesystem::path& parts) {
    stages::MeshRequest request = body.mesh;
    request.contract = case_file.quality;
    request.attempts = case_file.attempts;
    request.output = parts / (body.name + ".vtu");
    Stage stage{"mesh " + body.name, "mesh", {}, {}, {request.output}};
    if (!request.mesh_file.empty()) stage.inputs.push_back(request.mesh_file);
    if (needs_labels(case_file)) stage.inputs.push_back(request.labels = parts / "labels.seg.nrrd");
    stage.request = cli::to_request(request);
    return stage;
}

Stage condense_stage(const DeformableSpec& body, const std::filesystem::path& parts) {
    stages::CondenseRequest request = body.condense;
    request.mesh = parts / (body.name + ".vtu");
    request.output = parts / (body.name + ".body.h5");
    Stage stage{
        "condense " + body.name, "condense", cli::to_request(request), {request.mesh}, {request.output}};
    for (const std::filesystem::path& file : node_files(request)) stage.inputs.push_back(file);
    return stage;
}

std::filesystem::path provenance_file(const BuildPaths& paths) {
    return paths.parts / "provenance.json";
}

Stage pack_stage(const CaseFile& case_file, const BuildPaths& paths) {
    stages::PackRequest request;
    request.name = case_file.name;
    request.haptics = case_file.haptics;
    request.output = paths.asset;
    request.provenance = provenance_file(paths);
    Stage stage{"pack", "pack", {}, {request.provenance}, {paths.asset}};
    for (const RigidSpec& rigid : case_file.rigid) {
        request.rigid.push_back({rigid.name, paths.parts / (rigid.name + ".vtp"), {}});
        stage.inputs.push_back(request.rigid.back().body);
        request.colours.insert(request.colours.end(), rigid.colours.begin(), rigid.colours.end());
    }
    for (const DeformableSpec& deformable : case_file.deformable) {
        request.deformable.push_back({deformable.name, paths.parts / (deformable.name + ".body.h5"), {}});
        request.mesh_results.push_back(
            {deformable.name, paths.parts / ("mesh-" + deformable.name + ".json")});
        stage.inputs.push_back(request.deformable.back().body);
        stage.inputs.push_back(request.mesh_results.back().file);
        request.colours.insert(request.colours.end(), deformable.colours.begin(), deformable.colours.end());
        if (deformable.large_deformation) request.large_deformation.push_back(deformable.name);
    }
    if (case_file.volume && case_file.keep_scan)
        stage.inputs.push_back(request.scan = paths.parts / "volume.nrrd");
    if (needs_labels(case_file))
        stage.inputs.push_back(request.notes.emplace_back(paths.parts / "segment.json"));
    if (!case_file.sign.empty()) stage.inputs.push_back(request.sign = case_file.sign);
    stage.request = cli::to_request(request);
    return stage;
}

Stage touch_stage(const BuildPaths& paths, TouchClock clock) {
    const std::filesystem::path curve = paths.parts / "force.svg", log = paths.parts / "touch.csv";
    Json request{{"asset", paths.asset.string()},
                 {"script", "press"},
                 {"seconds", 4},
                 {"curve", curve.string()},
                 {"log", log.string()}};
    if (clock == TouchClock::virtual_time) request["virtual_clock"] = true;
    return {"touch", "touch", std::move(request), {paths.asset}, {curve, log}};
}

std::filesystem::path records_file(const BuildPaths& paths) {
    return paths.parts / "stages.json";
}

std::span<const Stage> stages_before(const Stage& stage, const std::vector<Stage>& stages) {
    const auto at = std::ranges::find(stages, stage.name, &Stage::name);
    return {stages.data(), static_cast<std::size_t>(at - stages.begin())};
}

void write_records(const BuildPaths& paths, std::span<const Stage> stages, const StageRunner& runner) {
    Json rows = Json::array();
    for (const Stage& stage : stages)
        if (const auto record = runner.recorded(stage.name))
            rows.push_back({{"stage", record->name},
                            {"seconds", record->seconds},
                            {"peak_memory_bytes", record->peak_memory_bytes}});
    cli::write_text_file(records_file(paths), rows.dump(2) + "\n", true);
}

Stage report_stage(const CaseFile& case_file, const BuildPaths& paths) {
    stages::ReportRequest request;
    request.asset = paths.asset;
    request.touch = paths.parts / "touch.json";
    request.curve = paths.parts / "force.svg";
    request.stages = records_file(paths);
    request.thumbnail = paths.parts / "thumbnail.png";
    request.output = paths.report;
    Stage stage{"report",
                "report",
                {},
                {request.asset, request.touch, request.curve, request.stages},
                {request.output, request.thumbnail}};
    if (needs_labels(case_file)) {
        stage.inputs.push_back(request.labels = paths.parts / "labels.seg.nrrd");
        for (const RigidSpec& body : case_file.rigid)
            if (body.surface.surface_file.empty())
                request.rigid.push_back({body.name, body.surface.label_names.front(), body.surface.isovalue});
    }
    if (case_file.volume) stage.inputs.push_back(request.volume = paths.parts / "volume.nrrd");
    stage.request = cli::to_request(request);
    return stage;
}

}  // namespace

std::vector<Stage> stages_of(const CaseFile& case_file, const BuildPaths& paths, TouchClock clock) {
    std::vector<Stage> stages;
    if (case_file.volume)
        stages.push_back(import_stage("import volume", case_file.volume_import, *case_file.volume,
                                      paths.parts / "volume.nrrd"));
    if (case_file.labels) stages.push_back(import_labels_stage(case_file, paths.parts / "prior.seg.nrrd"));
    if (needs_labels(case_file)) stages.push_back(segment_stage(case_file, paths.parts));
    for (const RigidSpec& body : case_file.rigid) stages.push_back(surface_stage(body, paths.parts));
    for (const DeformableSpec& body : case_file.deformable) {
        stages.push_back(mesh_stage(body, case_file, paths.parts));
        stages.push_back(condense_stage(body, paths.parts));
    }
    stages.push_back(pack_stage(case_file, paths));
    stages.push_back(touch_stage(paths, clock));
    stages.push_back(report_stage(case_file, paths));
    return stages;
}

void require_made(const Stage& stage, const std::vector<Stage>& stages, const StageRunner& runner) {
    for (const std::filesystem::path& input : stage.inputs) {
        const auto maker = std::ranges::find_if(stages, [&](const Stage& other) {
            return std::ranges::find(other.outputs, input) != other.outputs.end() ||
                   runner.result_path(other.name) == input;
        });
        if (maker != stages.end() && !std::filesystem::exists(input))
            throw InvalidInput({"stage '" + stage.name + "'",
                                "needs " + input.string() + ", which is not there", "",
                                "run stage '" + maker->name + "' first"});
    }
}

void prepare(const Stage& stage, const CaseFile& case_file, const BuildPaths& paths,
             const std::vector<Stage>& stages, const StageRunner& runner) {
    std::filesystem::create_directories(paths.parts);
    const auto before = stages_before(stage, stages);
    if (stage.name == "pack")
        cli::write_text_file(provenance_file(paths), provenance(case_file, before, &runner).dump(2) + "\n",
                             true);
    if (stage.name == "report") write_records(paths, before, runner);
}

std::filesystem::path failure_page(const BuildPaths& paths) {
    return paths.parts / "failure.html";
}

Stage failure_stage(const CaseFile& case_file, const BuildPaths& paths, const std::vector<Stage>& stages,
                    const Stage& failed, const StageRunner& runner) {
    const auto before = stages_before(failed, stages);
    write_records(paths, before, runner);
    stages::ReportRequest request;
    request.failed_with = runner.error_path(failed.name);
    request.name = case_file.name;
    request.stages = records_file(paths);
    request.output = failure_page(paths);
    Stage stage{"failure page", "report", {}, {request.failed_with, request.stages}, {request.output}};
    const auto was_made = [&](const char* name) {
        return std::ranges::find(before, name, &Stage::name) != before.end();
    };
    if (was_made("import volume")) stage.inputs.push_back(request.volume = paths.parts / "volume.nrrd");
    if (was_made("segment"))
        stage.inputs.push_back(request.labels = paths.parts / "labels.seg.nrrd");
    else if (was_made("import labels"))
        stage.inputs.push_back(request.labels = paths.parts / "prior.seg.nrrd");
    stage.request = cli::to_request(request);
    return stage;
}

}  // namespace palpate::case_builder
