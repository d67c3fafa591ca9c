// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>

#include "tools/meshing/mesh_to_contract.hpp"

namespace palpate::mesh {

using Json = nlohmann::ordered_json;

/// Size and shape of any mesh.
Json to_json(const TetMesh& mesh, const MeshQuality& quality);

/// The same and how faithful it is to its labels, region by region.
Json to_json(const TetMesh& mesh, const MeshMeasures& measures);

/// The contract's limits.
Json to_json(const QualityContract& contract);

/// What each attempt missed.
Json to_json(const std::vector<MeshAttempt>& attempts);

/// Throws QualityNotMet with every miss, if there is one; `culprit` is the output, `next_step` what to do.
void require_none(const std::vector<ContractMiss>& misses, const std::string& culprit,
                  const std::string& next_step);

}  // namespace palpate::mesh
