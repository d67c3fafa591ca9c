// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/records/haptic_settings.hpp"
#include "formats/records/quality_contract.hpp"
#include "tools/case_builder/overrides.hpp"
#include "tools/stages/requests/condense_request.hpp"
#include "tools/stages/requests/import_request.hpp"
#include "tools/stages/requests/mesh_request.hpp"
#include "tools/stages/requests/pack_request.hpp"
#include "tools/stages/requests/segment_request.hpp"
#include "tools/stages/requests/surface_request.hpp"

namespace palpate::case_builder {

/// A structure to segment: a recipe of `palpate segment` with its parameters as that command takes them.
struct StructureSpec {
    std::string name;
    std::string recipe;
    nlohmann::ordered_json parameters = nlohmann::ordered_json::object();  ///< in the order written
    std::map<std::string, std::filesystem::path> files;  ///< parameters that are files, resolved
};

/// A structure as `palpate segment` takes it; `file_value` writes a file that its recipe reads, under the
/// parameter's name and `key_ending`.
stages::StructureRequest structure_request(
    const StructureSpec& structure, const std::string& key_ending,
    const std::function<std::string(const std::filesystem::path&)>& file_value);

/// A rigid body: an imported surface, or the surface of a label, or of a grey isovalue near a label.
struct RigidSpec {
    std::string name;
    stages::SurfaceRequest surface;            ///< but for the volume, labels and output of the build
    std::vector<stages::DrawnColour> colours;  ///< one, or none: what its name suggests
};

/// The preset of a region's material.
struct RegionTissue {
    std::string label;
    std::string tissue;  ///< name of one of tissue::tissues()
};

/// A deformable body: regions meshed together, or an imported mesh of them, the nodes that are held and those
/// that can be touched.
struct DeformableSpec {
    std::string name;
    stages::MeshRequest mesh;                  ///< but for the labels and output of the build
    stages::CondenseRequest condense;          ///< but for the mesh and output of the build
    std::vector<RegionTissue> tissues;         ///< of the regions that name one
    std::vector<stages::DrawnColour> colours;  ///< of body and regions that name one
    bool large_deformation = false;            ///< felt as neo-Hookean tissue
};

/// A case file, schema 1: what to build for one patient. Paths are absolute or relative to the case file.
struct CaseFile {
    std::string name;
    std::optional<std::filesystem::path> volume;       ///< CT or MRI
    std::optional<std::filesystem::path> labels;       ///< label map that structures are imported from
    stages::ImportRequest volume_import;               ///< how to read it: series, gaps, frame
    stages::ImportRequest labels_import;               ///< how to read them: names, overlaps, frame
    bool keep_scan = true;                             ///< the asset gets the volume too, reduced
    std::optional<std::filesystem::path> label_table;  ///< the file that has their names, if one has
    std::vector<StructureSpec> structures;
    std::vector<RigidSpec> rigid;
    std::vector<DeformableSpec> deformable;
    HapticSettings haptics;
    std::filesystem::path sign;  ///< private key that signs the asset; of the command line, not of the file
    QualityContract quality;
    int attempts = stages::MeshRequest{}.attempts;  ///< to keep the contract
    std::string kept;                               ///< what the asset keeps of it, see kept_case()
};

/// Reads a case file, or the case that an asset was built from, some of its values replaced. Paths are as
/// from the folder of the file, or of the asset. Throws InvalidInput naming file, line and key for a syntax
/// error, an unknown key (with the nearest known ones), a missing or wrongly typed value, a name used twice
/// or unfit for a file name, or another schema.
CaseFile read_case_file(const std::filesystem::path& path, std::span<const Override> overrides = {});

/// Tells whether some stage needs the label map of the structures; imported meshes and surfaces alone do not.
bool needs_labels(const CaseFile& case_file);

/// Tells whether the structure is taken from a label map and names no file of its own.
bool imports_labels(const StructureSpec& structure);

}  // namespace palpate::case_builder
