// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/provenance.hpp"

#include <fmt/format.h>

#include "formats/asset/hdf5/digest.hpp"
#include "tools/case_builder/cautions.hpp"

namespace palpate::case_builder {
namespace {

using Json = nlohmann::ordered_json;

// A request without what leads to a person: imported files by what they are here, others without folders.
Json without_paths(Json json, const std::map<std::string, std::string>& imported) {
    if (json.is_structured()) {
        for (Json& item : json) item = without_paths(item, imported);
    } else if (json.is_string()) {
        const auto text = json.get<std::string>();
        if (const auto file = imported.find(text); file != imported.end()) return file->second;
        if (text.find('/') != std::string::npos) return std::filesystem::path(text).filename().string();
    }
    return json;
}

}  // namespace

Json provenance(const CaseFile& case_file, std::span<const Stage> before, const StageRunner* runner) {
    Json inputs = Json::object();
    if (case_file.volume) inputs["volume_sha256"] = content_digest(*case_file.volume);
    if (case_file.labels) inputs["labels_sha256"] = content_digest(*case_file.labels);
    if (case_file.label_table) inputs["label_names_sha256"] = content_digest(*case_file.label_table);
    std::map<std::string, std::string> imported;  // files may be called after a patient
    const auto add_imported = [&](const std::string& name, const std::filesystem::path& file) {
        if (file.empty()) return;
        inputs[name + "_file_sha256"] = content_digest(file);
        imported[file.string()] = name + file.extension().string();
    };
    for (const RigidSpec& body : case_file.rigid) add_imported(body.name, body.surface.surface_file);
    for (const DeformableSpec& body : case_file.deformable) {
        add_imported(body.name, body.mesh.mesh_file);
        const auto files = stages::node_files(body.condense);
        for (std::size_t i = 0; i < files.size(); ++i) {
            const std::string name = fmt::format("{}_nodes_{}", body.name, i + 1);
            inputs[name + "_sha256"] = content_digest(files[i]);
            imported[files[i].string()] = name;
        }
    }
    Json steps = Json::array();
    for (const Stage& stage : before) {
        if (stage.command == "import") continue;
        Json request = stage.request;
        if (stage.command == "segment") request.erase("structure");  // told below, by digests of their files
        Json& step = steps.emplace_back(
            Json{{"command", stage.command}, {"request", without_paths(request, imported)}});
        if (const auto record = runner != nullptr ? runner->recorded(stage.name) : std::nullopt)
            if (const Json::json_pointer threads("/plan/threads"); record->result.contains(threads))
                step["threads"] = record->result[threads];
    }
    Json structures = Json::array();
    for (const StructureSpec& structure : case_file.structures)
        structures.push_back(structure_request(structure, "_sha256", asset::sha256_file));
    Json json{{"case", case_file.kept},
              {"inputs", inputs},
              {"structures", structures},
              {"steps", steps},
              {"cautions", cautions_of(case_file)}};
    if (!keeps_series(case_file.volume_import.series)) json["series_left_out"] = true;
    return json;
}

std::vector<std::string> changed_since(const KeptBuild& then, const CaseFile& case_file) {
    const Json now = provenance(case_file, {});
    std::vector<std::string> changed;
    for (const auto& [name, digest] : now["inputs"].items())
        if (const auto found = then.inputs.find(name);
            found == then.inputs.end() || found->second != digest.get<std::string>())
            changed.push_back(name.substr(0, name.rfind("_sha256")));
    if (then.structures != now["structures"]) changed.emplace_back("structures");
    if (changed.empty() && then.case_text != case_file.kept) changed.emplace_back("case");
    return changed;
}

}  // namespace palpate::case_builder
