// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/stages.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>

#include "formats/asset/hdf5/digest.hpp"
#include "tools/cli/command.hpp"

namespace palpate::build {
namespace {

using Json = nlohmann::ordered_json;

void add_options(std::vector<std::string>& arguments, const std::map<std::string, double>& options) {
    for (const auto& [option, value] : options) {
        arguments.push_back(option);
        arguments.push_back(fmt::format("{}", value));
    }
}

void add(std::vector<std::string>& arguments, std::initializer_list<std::string> more) {
    arguments.insert(arguments.end(), more);
}

// A case names one frame for both inputs; import takes it for NIfTI files only.
void add_import_options(Stage& stage, std::vector<std::string> options, const std::filesystem::path& input) {
    std::string name = input.filename().string();
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
    if (const auto frame = std::ranges::find(options, "--nifti-frame");
        frame != options.end() && !name.ends_with(".nii") && !name.ends_with(".nii.gz"))
        options.erase(frame, frame + 2);
    stage.arguments.insert(stage.arguments.end(), options.begin(), options.end());
}

Stage import_volume_stage(const CaseFile& case_file, const std::filesystem::path& output) {
    Stage stage{"import volume", "import", {case_file.volume->string()}, {*case_file.volume}, {output}};
    add_import_options(stage, case_file.volume_options, *case_file.volume);
    add(stage.arguments, {"-o", output.string()});
    return stage;
}

Stage import_labels_stage(const CaseFile& case_file, const std::filesystem::path& output) {
    Stage stage{
        "import labels", "import", {case_file.labels->string(), "--labels"}, {*case_file.labels}, {output}};
    if (case_file.label_table) stage.inputs.push_back(*case_file.label_table);
    add_import_options(stage, case_file.labels_options, *case_file.labels);
    add(stage.arguments, {"-o", output.string()});
    return stage;
}

// The structures as `palpate segment --recipes` takes them; `file_value` writes a file that a recipe reads,
// under the parameter's name and `key_ending`.
template <typename FileValue>
Json recipes_json(const CaseFile& case_file, const std::string& key_ending, const FileValue& file_value) {
    Json recipes = Json::array();
    for (const StructureSpec& structure : case_file.structures) {
        Json parameters = structure.parameters;
        for (const auto& [key, file] : structure.files) parameters[key + key_ending] = file_value(file);
        recipes.push_back(
            {{"name", structure.name}, {"recipe", structure.recipe}, {"parameters", parameters}});
    }
    return recipes;
}

Stage segment_stage(const CaseFile& case_file, const std::filesystem::path& parts) {
    const Json recipes = recipes_json(case_file, "", [](const auto& file) { return file.string(); });
    const std::filesystem::path recipe_file = parts / "recipes.json", output = parts / "labels.seg.nrrd";
    cli::write_text_file(recipe_file, recipes.dump(2) + "\n", true);

    Stage stage{"segment", "segment", {"--recipes", recipe_file.string()}, {recipe_file}, {output}};
    for (const StructureSpec& structure : case_file.structures)
        for (const auto& [key, file] : structure.files) stage.inputs.push_back(file);
    if (case_file.volume) {
        add(stage.arguments, {"--volume", (parts / "volume.nrrd").string()});
        stage.inputs.push_back(parts / "volume.nrrd");
    }
    if (case_file.labels) {
        add(stage.arguments, {"--labels", (parts / "prior.seg.nrrd").string()});
        stage.inputs.push_back(parts / "prior.seg.nrrd");
    }
    add(stage.arguments, {"-o", output.string()});
    return stage;
}

// What a command takes of an imported mesh or surface; `option` names the file.
Stage imported_stage(const std::string& command, const std::string& name, const std::string& option,
                     const ImportedFile& file, const std::filesystem::path& output) {
    Stage stage{command + " " + name,
                command,
                {option, file.path.string(), "--unit", file.unit},
                {file.path},
                {output}};
    if (!file.frame.empty()) add(stage.arguments, {"--frame", file.frame});
    return stage;
}

Stage surface_stage(const RigidSpec& body, const std::filesystem::path& parts) {
    const std::filesystem::path labels = parts / "labels.seg.nrrd", output = parts / (body.name + ".vtp");
    Stage stage = body.file ? imported_stage("surface", body.name, "--surface-file", *body.file, output)
                            : Stage{"surface " + body.name,
                                    "surface",
                                    {"--labels", labels.string(), "--label", body.label},
                                    {labels},
                                    {output}};
    if (body.isovalue) {
        add(stage.arguments,
            {"--volume", (parts / "volume.nrrd").string(), "--isovalue", fmt::format("{}", *body.isovalue)});
        stage.inputs.push_back(parts / "volume.nrrd");
    }
    if (body.max_triangles) add(stage.arguments, {"--max-triangles", std::to_string(*body.max_triangles)});
    if (body.max_distance) add(stage.arguments, {"--max-distance", fmt::format("{}", *body.max_distance)});
    add(stage.arguments, {"-o", output.string()});
    return stage;
}

// An imported mesh; its regions get their labels' names, and its surface its neighbours if there are labels.
Stage imported_mesh_stage(const DeformableSpec& body, const std::map<std::string, double>& quality,
                          bool labels, const std::filesystem::path& parts) {
    Stage stage = imported_stage("mesh", body.name, "--mesh-file", *body.file, parts / (body.name + ".vtu"));
    for (const RegionSpec& region : body.regions)
        if (region.mesh_region)
            add(stage.arguments, {"--region-name", fmt::format("{}={}", *region.mesh_region, region.label)});
    if (labels) {
        add(stage.arguments, {"--labels", (parts / "labels.seg.nrrd").string()});
        stage.inputs.push_back(parts / "labels.seg.nrrd");
    }
    add_options(stage.arguments, quality);
    add(stage.arguments, {"-o", stage.outputs.front().string()});
    return stage;
}

Stage mesh_stage(const DeformableSpec& body, const std::map<std::string, double>& quality,
                 const std::filesystem::path& parts) {
    const std::filesystem::path labels = parts / "labels.seg.nrrd", output = parts / (body.name + ".vtu");
    Stage stage{"mesh " + body.name, "mesh", {"--labels", labels.string()}, {labels}, {output}};
    for (const RegionSpec& region : body.regions) {
        add(stage.arguments, {"--region", region.label});
        if (region.cell_size_mm)
            add(stage.arguments,
                {"--region-cell-size", fmt::format("{}={}", region.label, *region.cell_size_mm)});
    }
    for (const std::string& place : body.near) add(stage.arguments, {"--near", place});
    add_options(stage.arguments, body.sizing);
    add_options(stage.arguments, quality);
    add(stage.arguments, {"-o", output.string()});
    return stage;
}

Stage obb_stage(const std::string& name, const std::filesystem::path& mesh) {
    const std::filesystem::path output = mesh.parent_path() / (name + ".obb.h5");
    return {"obb " + name, "obb", {mesh.string(), "-o", output.string()}, {mesh}, {output}};
}

Stage condense_stage(const DeformableSpec& body, const std::filesystem::path& parts) {
    const std::filesystem::path mesh = parts / (body.name + ".vtu"),
                                output = parts / (body.name + ".body.h5");
    Stage stage{"condense " + body.name, "condense", {mesh.string(), "--name", body.name}, {mesh}, {output}};
    for (const RegionSpec& region : body.regions)
        add(stage.arguments, {"--material", fmt::format("{}:{},{}", region.label, region.youngs_modulus_kpa,
                                                        region.poissons_ratio)});
    for (const std::string& rule : body.fixed) add(stage.arguments, {"--fixed", rule});
    for (const std::string& rule : body.contact) add(stage.arguments, {"--contact", rule});
    stage.inputs.insert(stage.inputs.end(), body.node_files.begin(), body.node_files.end());
    stage.arguments.insert(stage.arguments.end(), body.condense_options.begin(), body.condense_options.end());
    add(stage.arguments, {"-o", output.string()});
    return stage;
}

// What made the asset: digests of the inputs and the parameters, no file names of the patient's.
Json provenance(const CaseFile& case_file, const std::vector<Stage>& stages) {
    Json inputs = Json::object();
    if (case_file.volume) inputs["volume_sha256"] = content_digest(*case_file.volume);
    if (case_file.labels) inputs["labels_sha256"] = content_digest(*case_file.labels);
    std::map<std::string, std::string> imported;  // files may be called after a patient
    const auto add_imported = [&](const std::string& name, const std::optional<ImportedFile>& file) {
        if (!file) return;
        inputs[name + "_file_sha256"] = content_digest(file->path);
        imported[file->path.string()] = name + file->path.extension().string();
    };
    for (const RigidSpec& body : case_file.rigid) add_imported(body.name, body.file);
    for (const DeformableSpec& body : case_file.deformable) {
        add_imported(body.name, body.file);
        for (std::size_t i = 0; i < body.node_files.size(); ++i) {
            const std::string name = fmt::format("{}_nodes_{}", body.name, i + 1);
            inputs[name + "_sha256"] = content_digest(body.node_files[i]);
            imported["nodes:" + body.node_files[i].string()] = "nodes:" + name;
        }
    }
    Json steps = Json::array();
    for (const Stage& stage : stages) {
        if (stage.command == "import") continue;
        std::string line = stage.command;
        for (const std::string& argument : stage.arguments)
            if (const auto file = imported.find(argument); file != imported.end())
                line += " " + file->second;
            else
                line += " " + (argument.find('/') == std::string::npos
                                   ? argument
                                   : std::filesystem::path(argument).filename().string());
        steps.push_back(line);
    }
    const Json structures = recipes_json(case_file, "_sha256", sha256_file);
    return {{"inputs", inputs}, {"structures", structures}, {"steps", steps}};
}

Stage pack_stage(const CaseFile& case_file, const BuildPaths& paths, const std::vector<Stage>& before) {
    const std::filesystem::path provenance_file = paths.parts / "provenance.json";
    cli::write_text_file(provenance_file, provenance(case_file, before).dump(2) + "\n", true);
    Stage stage{"pack",
                "pack",
                {"--name", case_file.name, "--provenance", provenance_file.string()},
                {provenance_file},
                {paths.asset}};
    const auto body = [&](const std::string& kind, const std::string& name, const std::string& extension) {
        const auto part = paths.parts / (name + extension), tree = paths.parts / (name + ".obb.h5");
        add(stage.arguments, {kind, name + "=" + part.string() + "," + tree.string()});
        stage.inputs.push_back(part);
        stage.inputs.push_back(tree);
    };
    for (const RigidSpec& rigid : case_file.rigid) body("--rigid", rigid.name, ".vtp");
    for (const DeformableSpec& deformable : case_file.deformable) {
        body("--deformable", deformable.name, ".body.h5");
        const auto result = paths.parts / ("mesh-" + deformable.name + ".json");
        add(stage.arguments, {"--mesh-result", deformable.name + "=" + result.string()});
        stage.inputs.push_back(result);
    }
    add_options(stage.arguments, case_file.haptics);
    add(stage.arguments, {"-o", paths.asset.string()});
    return stage;
}

}  // namespace

std::vector<Stage> stages_to_asset(const CaseFile& case_file, const BuildPaths& paths) {
    std::filesystem::create_directories(paths.parts);
    std::vector<Stage> stages;
    if (case_file.volume) stages.push_back(import_volume_stage(case_file, paths.parts / "volume.nrrd"));
    if (case_file.labels) stages.push_back(import_labels_stage(case_file, paths.parts / "prior.seg.nrrd"));
    const bool labels = needs_labels(case_file);
    if (labels) stages.push_back(segment_stage(case_file, paths.parts));
    for (const RigidSpec& body : case_file.rigid) {
        stages.push_back(surface_stage(body, paths.parts));
        stages.push_back(obb_stage(body.name, paths.parts / (body.name + ".vtp")));
    }
    for (const DeformableSpec& body : case_file.deformable) {
        stages.push_back(body.file ? imported_mesh_stage(body, case_file.quality, labels, paths.parts)
                                   : mesh_stage(body, case_file.quality, paths.parts));
        stages.push_back(obb_stage(body.name, paths.parts / (body.name + ".vtu")));
        stages.push_back(condense_stage(body, paths.parts));
    }
    stages.push_back(pack_stage(case_file, paths, stages));
    return stages;
}

Stage touch_stage(const BuildPaths& paths) {
    const std::filesystem::path curve = paths.parts / "force.svg", log = paths.parts / "touch.csv";
    return {"touch",
            "touch",
            {paths.asset.string(), "--script", "press", "--seconds", "4", "--curve", curve.string(), "--log",
             log.string()},
            {paths.asset},
            {curve, log}};
}

Stage report_stage(const CaseFile& case_file, const BuildPaths& paths,
                   const std::vector<StageRecord>& records, const std::filesystem::path& touch_result) {
    Json rows = Json::array();
    for (const StageRecord& record : records)
        rows.push_back({{"stage", record.name},
                        {"seconds", record.seconds},
                        {"peak_memory_bytes", record.peak_memory_bytes}});
    const std::filesystem::path stages_file = paths.parts / "stages.json", curve = paths.parts / "force.svg",
                                labels = paths.parts / "labels.seg.nrrd",
                                volume = paths.parts / "volume.nrrd";
    cli::write_text_file(stages_file, rows.dump(2) + "\n", true);
    Stage stage{"report",
                "report",
                {paths.asset.string(), "--touch", touch_result.string(), "--curve", curve.string(),
                 "--stages", stages_file.string()},
                {paths.asset, touch_result, curve, stages_file},
                {paths.report}};
    if (needs_labels(case_file)) {
        add(stage.arguments, {"--labels", labels.string()});
        stage.inputs.push_back(labels);
        for (const RigidSpec& body : case_file.rigid)
            if (!body.file)
                add(stage.arguments,
                    {"--rigid", body.name + "=" + body.label +
                                    (body.isovalue ? fmt::format(",{}", *body.isovalue) : std::string())});
    }
    if (case_file.volume) {
        add(stage.arguments, {"--volume", volume.string()});
        stage.inputs.push_back(volume);
    }
    add(stage.arguments, {"-o", paths.report.string()});
    return stage;
}

}  // namespace palpate::build
