// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/case.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "formats/asset/parts.hpp"
#include "formats/hyperelasticity/equilibrium.hpp"
#include "formats/model/errors.hpp"
#include "tools/cli/software.hpp"
#include "tools/fem/condensation/sway.hpp"
#include "tools/fem/feel/feel.hpp"
#include "tools/imaging/faces/face.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/files/shallow_json.hpp"
#include "tools/imaging/voxels/scan_of.hpp"
#include "tools/meshing/files/mesh_files.hpp"
#include "tools/meshing/files/surface_repair.hpp"
#include "tools/obb/build_obb_tree.hpp"
#include "tools/stages/bone_inside.hpp"

namespace palpate::stages {
namespace {

using Json = nlohmann::ordered_json;

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
    auto json = imaging::read_json_file<Json>(path);
    if (!json.is_object())
        throw InvalidInput(
            {path.string(), "is no JSON object, or nested more than 32 deep", "{...}", "mend the file"});
    if (json.contains("schema")) json.erase("schema");  // "palpate.mesh/1" is no path
    for (const auto& [key, value] : json.items()) {
        refuse_paths(key, path.string());
        if (key != "case") refuse_paths(value, path.string());  // whose files have lost their folders already
    }
    return json;
}

// What `palpate mesh --json` says of bodies' meshes, by body; times and memory differ from run to run and
// stay out of the asset.
Json read_mesh_results(const std::vector<NamedFile>& files) {
    Json meshes = Json::object();
    for (const auto& [name, file] : files) {
        Json result = read_provenance(file);
        for (const char* key : {"version", "seconds", "peak_memory_bytes"}) result.erase(key);
        meshes[name] = std::move(result);
    }
    return meshes;
}

constexpr auto face_note =
    "The scan kept in it shows a face, by which the patient can be known: before it is given away, build "
    "with "
    "input.deface = true, or with keep_scan = false.";

// What earlier stages told a person to look at; folders stay out of it.
Json read_notes(const std::vector<std::filesystem::path>& files) {
    Json notes = Json::array();
    for (const std::filesystem::path& file : files) {
        const auto result = imaging::read_json_file<Json>(file);
        const auto refuse = [&] {
            return InvalidInput({file.string(), "is no result", "what --json of a command wrote", ""});
        };
        if (!result.is_object()) throw refuse();
        for (const Json& note : result.value("notes", Json::array())) {
            if (!note.is_string()) throw refuse();
            std::string kept;
            std::istringstream words(note.get<std::string>());
            for (std::string word; words >> word;)
                kept += (kept.empty() ? "" : " ") + word.substr(word.find_last_of("/\\") + 1);
            notes.push_back(kept);
        }
    }
    return notes;
}

ObbTree tree_of(const BodyFiles& files, const TriangleMesh& surface) {
    return files.tree.empty() ? obb::build_obb_tree(surface) : asset::read_obb_part(files.tree, surface);
}

RigidBody read_rigid(const BodyFiles& files) {
    RigidBody body{files.name, meshing::read_surface(files.body), {}};
    meshing::require_sound_surface(body.surface, files.body.string());
    body.obb_tree = tree_of(files, body.surface);
    return body;
}

DeformableBody read_deformable(const BodyFiles& files) {
    DeformableBody body = asset::read_body_part(files.body);
    body.name = files.name;
    body.obb_tree = tree_of(files, body.boundary.surface);
    return body;
}

// Where all bodies are, p_P, mm.
std::vector<Eigen::Vector3d> points_of(const Case& made) {
    std::vector<Eigen::Vector3d> points;
    const auto add = [&](const std::vector<Eigen::Vector3d>& more) {
        points.insert(points.end(), more.begin(), more.end());
    };
    for (const RigidBody& body : made.rigid_bodies) add(body.surface.vertices);
    for (const DeformableBody& body : made.deformable_bodies) add(body.mesh.rest_positions);
    return points;
}

void draw_in(const DrawnColour& drawn, Case& made) {
    const std::string culprit = "colour of '" + drawn.body + "'";
    const auto rigid = std::ranges::find(made.rigid_bodies, drawn.body, &RigidBody::name);
    const auto soft = std::ranges::find(made.deformable_bodies, drawn.body, &DeformableBody::name);
    if (rigid != made.rigid_bodies.end() && drawn.region.empty()) {
        rigid->colour = drawn.colour;
    } else if (soft != made.deformable_bodies.end() && drawn.region.empty()) {
        soft->colour = drawn.colour;
    } else if (soft != made.deformable_bodies.end()) {
        const Label label = require_label(soft->mesh.region_names, drawn.region, culprit);
        std::erase_if(soft->region_colours, [&](const RegionColour& r) { return r.region == label.value; });
        soft->region_colours.push_back({label.value, drawn.colour});
        std::ranges::sort(soft->region_colours, {}, &RegionColour::region);
    } else {
        throw InvalidInput({culprit, "names no body of the case that has it", "",
                            "give the name of a body, and regions of elastic ones alone"});
    }
}

// Bodies that are to be felt as neo-Hookean tissue; one that cannot be is found here and not in the trainer.
void feel_as_hyperelastic(const std::string& name, Case& made) {
    const auto body = std::ranges::find(made.deformable_bodies, name, &DeformableBody::name);
    if (body == made.deformable_bodies.end())
        throw InvalidInput({"large deformation of '" + name + "'", "names no elastic body of the case", "",
                            "give the name of one"});
    const hyperelasticity::Equilibrium solvable(*body);
    body->large_deformation = true;
}

}  // namespace

MadeCase make_case(const PackRequest& request, int threads, const ProgressCallback& progress) {
    Case made{.name = request.name,
              .rigid_bodies = {},
              .deformable_bodies = {},
              .haptics = request.haptics,
              .provenance = ""};
    Json notes = read_notes(request.notes);
    progress("read parts and build trees", 0);
    for (const BodyFiles& files : request.rigid) made.rigid_bodies.push_back(read_rigid(files));
    for (const BodyFiles& files : request.deformable)
        made.deformable_bodies.push_back(read_deformable(files));
    for (const DrawnColour& drawn : request.colours) draw_in(drawn, made);
    for (const std::string& name : request.large_deformation) feel_as_hyperelastic(name, made);
    if (!request.scan.empty()) {
        progress("cut the scan to the bodies", 0.2);
        made.scan = imaging::scan_of(imaging::read_volume(request.scan), points_of(made));
        if (made.scan && imaging::shows_face(*made.scan)) notes.push_back(face_note);
    }
    std::vector<std::string> warnings;
    const auto warn = [&](const std::string& sentence, const std::string& remedy) {
        notes.push_back(sentence + ".");
        warnings.push_back(sentence + "; " + remedy);
    };
    for (DeformableBody& body : made.deformable_bodies) {
        progress("press " + body.name + " all over", 0.3);
        body.feel = fem::feel_of(body, made.haptics.tool_radius, threads);
        const std::string name = "\u2018" + body.name + "\u2019 ";
        if (const fem::Sway sway = fem::sway_of(body); fem::hangs(body, sway))
            warn(name + fem::hanging_text(sway),
                 "hold it there too ('fixed'), or thicken what links it ('close_mm')");
        if (!made.scan) continue;
        if (const std::string bone = bone_text(bone_inside(body.mesh, *made.scan)); !bone.empty())
            warn(name + bone,
                 "look at its slices, and leave that out of its structure or make it a body of its own");
    }
    made.provenance = Json{
        {"software", cli::software_versions()},
        {"build", read_provenance(request.provenance)},
        {"meshes", read_mesh_results(request.mesh_results)},
        {"notes", notes}}.dump();
    return {std::move(made), std::move(warnings)};
}

}  // namespace palpate::stages
