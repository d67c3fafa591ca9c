// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace palpate::build {

/// A structure to segment: a recipe of `palpate segment` with its parameters as that command takes them.
struct StructureSpec {
    std::string name;
    std::string recipe;
    nlohmann::ordered_json parameters = nlohmann::ordered_json::object();  ///< in the order written
    std::map<std::string, std::filesystem::path>
        files;  ///< parameters file, seeds_file and scribbles, resolved
};

/// A mesh or surface that somebody made elsewhere.
struct ImportedFile {
    std::filesystem::path path;
    std::string unit = "mm";  ///< um, mm, cm, m or in
    std::string frame{};      ///< lps or ras; empty: what the file states, else lps
};

/// A rigid body: an imported surface, or the surface of a label, or of a grey isovalue near a label.
struct RigidSpec {
    std::string name;
    std::optional<ImportedFile> file;
    std::string label;
    std::optional<double> isovalue;  ///< HU
    std::optional<std::int64_t> max_triangles;
    std::optional<double> max_distance;  ///< mm that decimation may move the surface
};

/// One region of a deformable body.
struct RegionSpec {
    std::string label;
    double youngs_modulus_kpa = 0;
    double poissons_ratio = 0;
    std::optional<double> cell_size_mm;
    std::optional<std::int64_t> mesh_region;  ///< its value in an imported mesh
};

/// A deformable body: regions meshed together, or an imported mesh of them, with rules of `palpate condense`
/// for the nodes that are held and for those that can be touched.
struct DeformableSpec {
    std::string name;
    std::optional<ImportedFile> file;
    std::vector<RegionSpec> regions;
    std::vector<std::string> fixed;                 ///< "touching:skull", "sphere:x,y,z,r", ...
    std::vector<std::string> contact;               ///< likewise; none: all that is not fixed
    std::vector<std::filesystem::path> node_files;  ///< those that rules "nodes:FILE" name, resolved
    std::vector<std::string> condense_options;      ///< of `palpate condense`: element, accuracy, budgets
    std::vector<std::string> near;         ///< "tumour=3,10", "x,y,z=3,10", as `palpate mesh --near` takes it
    std::map<std::string, double> sizing;  ///< options of `palpate mesh` by name, mm or degrees
};

/// A case file, schema 1: what to build for one patient. Paths are absolute or relative to the case file.
struct CaseFile {
    std::string name;
    std::optional<std::filesystem::path> volume;       ///< CT or MRI
    std::optional<std::filesystem::path> labels;       ///< label map that structures are imported from
    std::vector<std::string> volume_options;           ///< of `palpate import`: series, gaps, frame
    std::vector<std::string> labels_options;           ///< of `palpate import`: names, overlaps, frame
    std::optional<std::filesystem::path> label_table;  ///< the file among labels_options, if one is
    std::vector<StructureSpec> structures;
    std::vector<RigidSpec> rigid;
    std::vector<DeformableSpec> deformable;
    std::map<std::string, double> haptics;  ///< options of `palpate pack` by name
    std::map<std::string, double> quality;  ///< contract options of `palpate mesh` by name
};

/// Reads a case file. Throws InvalidInput naming file, line and key for a syntax error, an unknown key (with
/// the nearest known ones), a missing or wrongly typed value, a name used twice or unfit for a file name, or
/// another schema.
CaseFile read_case_file(const std::filesystem::path& path);

/// Tells whether some stage needs the label map of the structures; imported meshes and surfaces alone do not.
bool needs_labels(const CaseFile& case_file);

/// Throws InvalidInput if a body asks for a grey isovalue and no volume is named.
void require_what_the_bodies_need(const CaseFile& case_file);

}  // namespace palpate::build
