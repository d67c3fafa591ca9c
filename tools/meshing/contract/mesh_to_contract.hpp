// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>

#include "tools/meshing/contract/contract.hpp"
#include "tools/meshing/tetrahedra/tetrahedralise.hpp"

namespace palpate::meshing {

/// One mesh on the way to the contract.
struct MeshAttempt {
    std::size_t tetrahedra = 0;
    std::vector<ContractCheck> misses;
};

/// A mesh, what was measured of it, its contract check by check, and the attempts that led to it, its own
/// last.
struct ContractedMesh {
    TetMesh mesh;
    MeshMeasures measures;
    std::vector<ContractCheck> checks;
    std::vector<MeshAttempt> attempts;
};

/// Meshes a body and, while the result misses the contract, meshes it anew with what missed made finer: the
/// surfaces of regions that are not faithful, the surroundings of tetrahedra that are flat. Returns the last
/// of at most `max_attempts` meshes; it keeps the contract if its attempt has no misses. Throws as
/// tetrahedralise() does.
ContractedMesh mesh_to_contract(const LabelMap& map, std::span<const std::int32_t> region_values,
                                MeshSizing sizing, const QualityContract& contract, int max_attempts,
                                const ProgressCallback& progress = {});

}  // namespace palpate::meshing
