// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <optional>

#include "formats/model/errors.hpp"
#include "formats/model/progress.hpp"
#include "formats/model/tet_mesh.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/stages/requests/mesh_request.hpp"

namespace palpate::stages {

/// A mesh and what there is to say of it.
struct MadeMesh {
    TetMesh mesh;                          ///< LPS mm
    nlohmann::ordered_json result;         ///< size, shape, fidelity, attempts, checks
    std::optional<ErrorDetail> shortfall;  ///< what a mesh that misses its contract lacks
};

/// Meshes labels, or reads an imported mesh and checks it against the labels if there is one for each of its
/// regions; writes nothing. Throws UsageError if the request has nothing to mesh or a size for a label that
/// is no region, InvalidInput if the body has several pieces and may not, and as what it calls.
MadeMesh make_mesh(const MeshRequest& request, const ProgressCallback& progress,
                   const imaging::NoteSink& note);

}  // namespace palpate::stages
