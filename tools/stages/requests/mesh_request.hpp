// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/cli/command.hpp"
#include "tools/meshing/contract/contract.hpp"
#include "tools/meshing/tetrahedra/tetrahedralise.hpp"

namespace palpate::stages {

/// Another cell size for one label: "tumour=4" or {"label": "tumour", "cell_size_mm": 4}.
struct LabelCellSize {
    std::string label;     ///< name or value
    double cell_size = 0;  ///< mm
};

/// Finer cells near a place: "tumour=3,10", "12,-40,88=3,10" or {"near": "tumour" or [12, -40, 88],
/// "within_mm": 10, "cell_size_mm": 3}.
struct NearPlace {
    std::string label;                           ///< name or value, unless it is a point
    std::optional<std::array<double, 3>> point;  ///< p_P, mm
    double within = 0;                           ///< mm
    double cell_size = 0;                        ///< mm
};

/// The name of an imported mesh's region: "4=tumour" or {"mesh_region": 4, "label": "tumour"}.
struct RegionNaming {
    std::int32_t mesh_region = 0;
    std::string label;
};

void to_json(nlohmann::ordered_json& json, const LabelCellSize& size);
void from_json(const nlohmann::ordered_json& json, LabelCellSize& size);
void to_json(nlohmann::ordered_json& json, const NearPlace& place);
void from_json(const nlohmann::ordered_json& json, NearPlace& place);
void to_json(nlohmann::ordered_json& json, const RegionNaming& naming);
void from_json(const nlohmann::ordered_json& json, RegionNaming& naming);

/// What `palpate mesh` is asked for: labels to mesh, or an imported mesh to check.
struct MeshRequest {
    std::filesystem::path labels;
    std::vector<std::string> regions;  ///< labels of the body, by name or value
    std::filesystem::path mesh_file;   ///< imported; labels are then what it is checked against
    std::string unit = "mm", frame;    ///< of that file
    std::vector<RegionNaming> region_names;
    meshing::MeshSizing sizing;  ///< its regions and places are those of the two lists
    std::vector<LabelCellSize> region_cell_sizes;
    std::vector<NearPlace> near;
    bool allow_components = false;  ///< of several separate pieces
    QualityContract contract;
    static constexpr int most_attempts = 100;
    int attempts = 4;               ///< meshes to make before the contract counts as missed
    std::filesystem::path preview;  ///< picture of the result to write as well (.png)
    std::filesystem::path output;   ///< .vtu
};

/// Binds the options of `palpate mesh`.
void declare(cli::Command& command, MeshRequest& request);

}  // namespace palpate::stages
