// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/bone_inside.hpp"

#include <fmt/format.h>

#include "tools/meshing/contract/fidelity.hpp"

namespace palpate::stages {
namespace {

// HU. Organs and veins full of contrast stay below; a choice.
constexpr double dense_hu = 300;

}  // namespace

BoneInside bone_inside(const TetMesh& mesh, const Scan& scan) {
    if (!scan.hounsfield) return {};
    const std::vector<std::int32_t> regions = meshing::voxelise(mesh, scan.grid);
    std::int64_t all = 0, dense = 0;
    for (std::size_t voxel = 0; voxel < regions.size(); ++voxel) {
        if (regions[voxel] == 0) continue;
        ++all;
        dense += scan.values[voxel] >= dense_hu;
    }
    if (all == 0) return {};
    return {static_cast<double>(dense) * scan.grid.voxel_volume(),
            static_cast<double>(dense) / static_cast<double>(all)};
}

std::string bone_text(const BoneInside& found) {
    constexpr double least_volume = 500, least_share = 0.01;  // mm³
    if (found.volume < least_volume || found.share < least_share) return "";
    return fmt::format(
        "holds {:.1f} ml ({:.0f} %) of {:g} HU and more, as bone, calcium or an artery full of contrast has, "
        "and is as soft there as elsewhere",
        found.volume / 1000, 100 * found.share, dense_hu);
}

}  // namespace palpate::stages
