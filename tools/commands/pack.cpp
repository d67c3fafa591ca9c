// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/asset/asset.hpp"
#include "formats/asset/hdf5/digest.hpp"
#include "formats/asset/parts.hpp"
#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/record_options.hpp"
#include "tools/cli/software.hpp"
#include "tools/meshing/files/mesh_files.hpp"

namespace {
using namespace palpate;
using Json = nlohmann::ordered_json;

// "skull=skull.vtp,skull.obb.h5": a body's name and its two files.
struct BodyParts {
    std::string name;
    std::filesystem::path body, tree;
};

BodyParts parse_parts(const std::string& option, const std::string& text, const std::string& form) {
    const auto equals = text.find('='), comma = text.rfind(',');
    if (equals == std::string::npos || equals == 0 || comma == std::string::npos || comma <= equals + 1 ||
        comma + 1 == text.size())
        throw UsageError({option + " " + text, "cannot be read", form, "see 'palpate pack --help'"});
    return {text.substr(0, equals), text.substr(equals + 1, comma - equals - 1), text.substr(comma + 1)};
}

// A slash may be a folder of whoever made the asset, and folders carry names of people.
void refuse_paths(const Json& value, const std::string& culprit) {
    if (value.is_structured())
        for (const auto& [key, item] : value.items()) {
            refuse_paths(key, culprit);
            refuse_paths(item, culprit);
        }
    else if (value.is_string() &&
             value.get_ref<const std::string&>().find_first_of("/\\") != std::string::npos)
        throw InvalidInput(
            {culprit, "holds a path: \"" + value.get<std::string>() + '"', "no '/' and no '\\'",
             "give file names without folders; an asset carries nothing that leads to a person"});
}

Json read_provenance(const std::filesystem::path& path) {
    if (path.empty()) return Json::object();
    std::ifstream stream(path, std::ios::binary);
    Json json;
    try {
        json = Json::parse(stream);
    } catch (const Json::parse_error& error) {
        throw InvalidInput({path.string(), error.what(), "JSON", "mend the file"});
    }
    if (json.contains("schema")) json.erase("schema");  // "palpate.mesh/1" is no path
    refuse_paths(json, path.string());
    return json;
}

// What `palpate mesh --json` says of bodies' meshes, by body; times and memory differ from run to run and
// stay out of the asset.
Json read_mesh_results(const std::vector<std::string>& texts) {
    Json meshes = Json::object();
    for (const std::string& text : texts) {
        const auto equals = text.find('=');
        if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
            throw UsageError(
                {"--mesh-result " + text, "cannot be read", "NAME=RESULT.json", "see 'palpate pack --help'"});
        Json result = read_provenance(text.substr(equals + 1));
        for (const char* key : {"version", "seconds", "peak_memory_bytes"}) result.erase(key);
        meshes[text.substr(0, equals)] = std::move(result);
    }
    return meshes;
}

RigidBody read_rigid(const BodyParts& parts) {
    RigidBody body{parts.name, read_surface(parts.body), {}};
    body.obb_tree = read_obb_part(parts.tree, body.surface);
    return body;
}

DeformableBody read_deformable(const BodyParts& parts) {
    DeformableBody body = read_body_part(parts.body);
    body.name = parts.name;
    body.obb_tree = read_obb_part(parts.tree, body.boundary.surface);
    return body;
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "pack",
         .summary =
             "Joins bodies, OBB trees and haptic settings to one asset that the trainer and ParaView open.",
         .examples =
             {"palpate pack --name liver --deformable liver=liver.body.h5,liver.obb.h5 -o liver.vtkhdf",
              "palpate pack --name head --rigid skull=skull.vtp,skull.obb.h5 "
              "--deformable wall=wall.body.h5,wall.obb.h5 --tool-radius 1.5 -o head.vtkhdf"},
         .notes = "Digests say whether parts belong together: an OBB tree to its surface, a compliance to "
                  "its mesh.\n"
                  "The provenance in the asset is the software's versions and the JSON given; no paths."});
    std::string name;
    std::vector<std::string> rigid, deformable, mesh_results;
    std::filesystem::path provenance, output;
    HapticSettings haptics;
    command.option("--name", name, "name of the case; no patient's name").required();
    command.option("--rigid", rigid, "rigid body: NAME=SURFACE.vtp,TREE.obb.h5; repeat for more");
    command.option("--deformable", deformable,
                   "elastic body: NAME=BODY.body.h5,TREE.obb.h5; repeat for more");
    cli::record_options(command, haptic_fields, haptics);
    command.option("--mesh-result", mesh_results,
                   "NAME=RESULT.json: what palpate mesh --json said of a body; repeat for more");
    command.input("--provenance", provenance, "what made the parts (.json)");
    command.output("-o,--output", output, "asset (.vtkhdf)").required();
    return command.run(argc, argv, [&](cli::Session& session) {
        cli::StagedFile staged = session.stage(output);
        Case patient_case{
            .name = name, .rigid_bodies = {}, .deformable_bodies = {}, .haptics = haptics, .provenance = ""};
        patient_case.provenance = Json{{"software", cli::software_versions()},
                                       {"build", read_provenance(provenance)},
                                       {"meshes", read_mesh_results(mesh_results)}}
                                      .dump();
        session.progress.step("read parts", 0);
        for (const std::string& text : rigid)
            patient_case.rigid_bodies.push_back(
                read_rigid(parse_parts("--rigid", text, "NAME=SURFACE.vtp,TREE.obb.h5")));
        for (const std::string& text : deformable)
            patient_case.deformable_bodies.push_back(
                read_deformable(parse_parts("--deformable", text, "NAME=BODY.body.h5,TREE.obb.h5")));
        session.progress.step("write the asset", 0.5);
        write_asset(staged.path(), patient_case);
        const std::string digest = sha256_file(staged.path());
        const auto size = std::filesystem::file_size(staged.path());
        staged.commit();
        return Json{{"asset", output.filename().string()},
                    {"name", name},
                    {"rigid_bodies", patient_case.rigid_bodies.size()},
                    {"deformable_bodies", patient_case.deformable_bodies.size()},
                    {"bytes", size},
                    {"sha256", digest}};
    });
}
