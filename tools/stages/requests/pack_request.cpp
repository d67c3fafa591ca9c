// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/requests/pack_request.hpp"

#include "tools/cli/items.hpp"
#include "tools/cli/record_options.hpp"

namespace palpate::stages {
namespace {

using Json = nlohmann::ordered_json;

// "NAME=BODY" or "NAME=BODY,TREE".
BodyFiles parse_files(const std::string& text, const char* option, const char* form) {
    const auto equals = text.find('='), comma = text.rfind(',');
    const bool tree = comma != std::string::npos && equals != std::string::npos && comma > equals;
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size() ||
        (tree && (comma == equals + 1 || comma + 1 == text.size())))
        throw UsageError({option + (" " + text), "cannot be read", form, "see 'palpate pack --help'"});
    return {text.substr(0, equals), text.substr(equals + 1, tree ? comma - equals - 1 : std::string::npos),
            tree ? text.substr(comma + 1) : ""};
}

BodyFiles parse_rigid(const std::string& text) {
    return parse_files(text, "--rigid", "NAME=SURFACE.vtp or NAME=SURFACE.vtp,TREE.obb.h5");
}

BodyFiles parse_deformable(const std::string& text) {
    return parse_files(text, "--deformable", "NAME=BODY.body.h5 or NAME=BODY.body.h5,TREE.obb.h5");
}

NamedFile parse_mesh_result(const std::string& text) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
        throw UsageError(
            {"--mesh-result " + text, "cannot be read", "NAME=RESULT.json", "see 'palpate pack --help'"});
    return {text.substr(0, equals), text.substr(equals + 1)};
}

Colour require_colour(const std::string& text, const std::string& culprit) {
    const auto colour = parse_colour(text);
    if (!colour) throw UsageError({culprit, "'" + text + "' is no colour", "such as #7a3a2f", ""});
    return *colour;
}

DrawnColour parse_drawn_colour(const std::string& text) {
    const auto equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0)
        throw UsageError({"--colour " + text, "cannot be read", "BODY=#RRGGBB or BODY:REGION=#RRGGBB",
                          "for example liver:tumour=#c8b8a0"});
    const std::string name = text.substr(0, equals);
    const auto colon = name.find(':');
    return {name.substr(0, colon), colon == std::string::npos ? "" : name.substr(colon + 1),
            require_colour(text.substr(equals + 1), "--colour " + text)};
}

}  // namespace

void to_json(Json& json, const BodyFiles& files) {
    json = {{"name", files.name}, {"body", files.body.string()}};
    if (!files.tree.empty()) json["tree"] = files.tree.string();
}

void from_json(const Json& json, BodyFiles& files) {
    cli::refuse_other_keys(json, {"name", "body", "tree"});
    files = {json.at("name"), json.at("body").get<std::string>(), json.value("tree", "")};
}

void to_json(Json& json, const NamedFile& file) {
    json = {{"name", file.name}, {"file", file.file.string()}};
}

void from_json(const Json& json, NamedFile& file) {
    cli::refuse_other_keys(json, {"name", "file"});
    file = {json.at("name"), json.at("file").get<std::string>()};
}

void to_json(Json& json, const DrawnColour& drawn) {
    json = {{"body", drawn.body}};
    if (!drawn.region.empty()) json["region"] = drawn.region;
    json["colour"] = colour_text(drawn.colour);
}

void from_json(const Json& json, DrawnColour& drawn) {
    cli::refuse_other_keys(json, {"body", "region", "colour"});
    drawn = {json.at("body"), json.value("region", ""), require_colour(json.at("colour"), "colour")};
}

void declare(cli::Command& command, PackRequest& request) {
    command.option("--name", request.name, "name of the case; no patient's name").required();
    command.items(
        "--rigid", cli::item_list(request.rigid, parse_rigid),
        "rigid body: NAME=SURFACE.vtp, with ,TREE.obb.h5 if its tree is not to be built; repeat for "
        "more");
    command.items("--deformable", cli::item_list(request.deformable, parse_deformable),
                  "elastic body: NAME=BODY.body.h5, likewise; repeat for more");
    cli::record_options(command, haptic_fields, request.haptics);
    command.input(
        "--scan", request.scan,
        "volume that the bodies were made from, for the trainer to show: cut to their box and 10 mm "
        "around it, reduced to 12 MB");
    command.items("--colour", cli::item_list(request.colours, parse_drawn_colour),
                  "BODY=#RRGGBB or BODY:REGION=#RRGGBB: what the trainer draws it in; repeat for more");
    command.option(
        "--large-deformation", request.large_deformation,
        "elastic body that touch and train feel as neo-Hookean tissue unless told otherwise; repeat "
        "for more");
    command.items("--mesh-result", cli::item_list(request.mesh_results, parse_mesh_result),
                  "NAME=RESULT.json: what palpate mesh --json said of a body; repeat for more");
    command.input("--notes", request.notes,
                  "result of import or segment (.json) whose notes the asset keeps; repeat for more");
    command.input("--provenance", request.provenance, "what made the parts (.json)");
    command.input("--sign", request.sign,
                  "private key (Ed25519, PEM) to sign the asset with, for those who load what they trust");
    command.output("-o,--output", request.output, "asset (.vtkhdf)").required();
}

}  // namespace palpate::stages
