// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "formats/model/colour.hpp"
#include "formats/records/haptic_settings.hpp"
#include "tools/cli/command.hpp"

namespace palpate::stages {

/// A body's files: "skull=skull.vtp", "skull=skull.vtp,skull.obb.h5" or {"name": "skull", "body":
/// "skull.vtp", "tree": "skull.obb.h5"}.
struct BodyFiles {
    std::string name;
    std::filesystem::path body;  ///< surface (.vtp) or condensed body (.body.h5)
    std::filesystem::path tree;  ///< OBB tree (.obb.h5); empty: it is built
};

/// What `palpate mesh --json` said of a body: "wall=wall.json" or {"name": "wall", "file": "wall.json"}.
struct NamedFile {
    std::string name;
    std::filesystem::path file;
};

/// What a body, or a region of one, is drawn in: "liver=#7a3a2f", "liver:tumour=#c8b8a0" or {"body": "liver",
/// "region": "tumour", "colour": "#c8b8a0"}.
struct DrawnColour {
    std::string body;
    std::string region;  ///< its label; empty: all of the body that has no colour of its own
    Colour colour{};
};

void to_json(nlohmann::ordered_json& json, const BodyFiles& files);
void from_json(const nlohmann::ordered_json& json, BodyFiles& files);
void to_json(nlohmann::ordered_json& json, const NamedFile& file);
void from_json(const nlohmann::ordered_json& json, NamedFile& file);
void to_json(nlohmann::ordered_json& json, const DrawnColour& drawn);
void from_json(const nlohmann::ordered_json& json, DrawnColour& drawn);

/// What `palpate pack` is asked for.
struct PackRequest {
    std::string name;  ///< of the case
    std::vector<BodyFiles> rigid, deformable;
    HapticSettings haptics;
    std::filesystem::path sign;  ///< private key (PEM); empty: the asset is not signed
    std::filesystem::path scan;  ///< the volume that the bodies were made from, for the eye; may be empty
    std::vector<DrawnColour> colours;
    std::vector<std::string> large_deformation;  ///< elastic bodies felt as neo-Hookean tissue
    std::vector<NamedFile> mesh_results;
    std::vector<std::filesystem::path> notes;  ///< results (.json) whose notes the asset keeps
    std::filesystem::path provenance;          ///< what made the parts (.json); may be empty
    std::filesystem::path output;              ///< .vtkhdf
};

/// Binds the options of `palpate pack`.
void declare(cli::Command& command, PackRequest& request);

}  // namespace palpate::stages
