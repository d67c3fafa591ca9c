// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "formats/model/scan.hpp"
#include "formats/model/tet_mesh.hpp"

namespace palpate::stages {

/// What of a mesh lies where a CT shows bone, calcium or an artery full of contrast.
struct BoneInside {
    double volume = 0;  ///< mm³ of voxels of 300 HU or more
    double share = 0;   ///< of the mesh's voxels
};

/// Looks at every voxel whose middle is in the mesh, both in frame P; nothing of a scan that is not in HU.
/// Cost: as meshing::voxelise().
BoneInside bone_inside(const TetMesh& mesh, const Scan& scan);

/// "holds 1.2 ml (3 %) of 300 HU and more, ..." where that is half a millilitre and a hundredth of the mesh
/// or more; else empty. Both are choices.
std::string bone_text(const BoneInside& found);

}  // namespace palpate::stages
