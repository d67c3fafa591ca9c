// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>

#include "formats/model/errors.hpp"
#include "tools/meshing/contract/mesh_to_contract.hpp"

namespace palpate::stages {

using Json = nlohmann::ordered_json;

/// Size and shape of any mesh.
Json to_json(const TetMesh& mesh, const meshing::MeshQuality& quality);

/// The same and how faithful it is to its labels, region by region.
Json to_json(const TetMesh& mesh, const meshing::MeshMeasures& measures);

/// The contract check by check, as numbers.
Json to_json(std::span<const meshing::ContractCheck> checks);

/// What each attempt missed.
Json to_json(const std::vector<meshing::MeshAttempt>& attempts);

/// Every check that is not met, if there is one, for QualityNotMet; `culprit` is the output, `next_step` what
/// to do.
std::optional<ErrorDetail> shortfall_of(std::span<const meshing::ContractCheck> checks,
                                        const std::string& culprit, const std::string& next_step);

}  // namespace palpate::stages
