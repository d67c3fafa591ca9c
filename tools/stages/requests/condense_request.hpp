// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "formats/records/material.hpp"
#include "tools/cli/command.hpp"

namespace palpate::stages {

/// A region's material: "liver:6.3,0.45" or {"label": "liver", "youngs_modulus_kpa": 6.3, "poissons_ratio":
/// 0.45}.
struct LabelMaterial {
    std::string label;  ///< name or value
    double youngs_modulus_kpa = 0;
    double poissons_ratio = 0;
};

/// A term of a region's relaxation, see RelaxationTerm: "liver:0.3,1" or {"label": "liver", "share": 0.3,
/// "time_s": 1}.
struct LabelRelaxation {
    std::string label;  ///< name or value
    RelaxationTerm term;
};

/// A region's density: "liver:1060" or {"label": "liver", "density_kg_m3": 1060}.
struct LabelDensity {
    std::string label;  ///< name or value
    double density_kg_m3 = 0;
};

/// What picks nodes; one member but the words is set. Positions and radius are LPS mm.
struct NodePick {
    std::string words;              ///< as people type it, see parse_node_rule(); else:
    std::string touching;           ///< the label beyond the surface, or "background"
    std::string region;             ///< name or value
    std::vector<double> box_mm;     ///< x0, y0, z0, x1, y1, z1
    std::vector<double> sphere_mm;  ///< x, y, z, r
    std::vector<double> plane_mm;   ///< x, y, z, nx, ny, nz
    std::vector<double> facing;     ///< nx, ny, nz
    std::filesystem::path nodes_file;
};

void to_json(nlohmann::ordered_json& json, const LabelMaterial& material);
void from_json(const nlohmann::ordered_json& json, LabelMaterial& material);
void to_json(nlohmann::ordered_json& json, const LabelRelaxation& relaxation);
void from_json(const nlohmann::ordered_json& json, LabelRelaxation& relaxation);
void to_json(nlohmann::ordered_json& json, const LabelDensity& density);
void from_json(const nlohmann::ordered_json& json, LabelDensity& density);
void to_json(nlohmann::ordered_json& json, const NodePick& pick);
void from_json(const nlohmann::ordered_json& json, NodePick& pick);

/// What `palpate condense` is asked for.
struct CondenseRequest {
    std::filesystem::path mesh;  ///< .vtu
    std::string name;            ///< of the body; empty: the mesh file's
    std::vector<LabelMaterial> materials;
    std::vector<LabelRelaxation> relaxation;  ///< of each region by ascending time
    std::vector<LabelDensity> densities;
    std::string scanned_posture, felt_posture;  ///< see fem::gravity_in(); both empty: the shape stays
    std::vector<NodePick> fixed, contact;       ///< no contact: all surface nodes that are not fixed
    std::string element = "linear";             ///< or "quadratic"
    std::string representation = "auto";        ///< or "dense", "hierarchical"
    static constexpr double finest_accuracy = 1e-4;
    double accuracy = 1e-3;             ///< relative error of a hierarchical compliance
    double memory_gib = 0;              ///< that may be in use at once; 0: what the machine has left
    double size_mib = 1024;             ///< that the compliance may have in the file
    bool discretisation_error = false;  ///< estimate it
    std::filesystem::path output;       ///< .body.h5
};

/// The files that list nodes, in the order of the rules.
std::vector<std::filesystem::path> node_files(const CondenseRequest& request);

/// Binds the options of `palpate condense`.
void declare(cli::Command& command, CondenseRequest& request);

}  // namespace palpate::stages
