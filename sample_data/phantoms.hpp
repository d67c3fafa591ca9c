// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>

#include "formats/model/image_grid.hpp"
#include "formats/model/label_map.hpp"

namespace palpate {

/// How a phantom is imaged. The anatomy stays where it is in P; the grid changes around it.
struct PhantomOptions {
    Eigen::Vector3d spacing{2, 2, 2};                         ///< mm; 2 mm gives 64 x 64 x 64 voxels
    Eigen::Matrix3d direction = Eigen::Matrix3d::Identity();  ///< orthonormal columns, as in ImageGrid
    int samples_per_axis = 1;  ///< partial volume: a voxel is the mean of this many samples cubed
    double noise_hu = 0;       ///< standard deviation of Gaussian noise
    std::uint64_t seed = 1;    ///< of the noise
};

/// A CT with whole HU values, and what is at each voxel's centre.
struct Phantom {
    Volume volume;
    LabelMap truth;
};

/// An abdomen about the origin of P in a cube of 128 mm: "liver" (30 x 24 x 26 mm semi-axes, cut by what
/// follows) with an enclosed "tumour" (9 mm radius at (-22, -10, 4)), "vessels", "spine" and "ribs", in soft
/// tissue that the volume's ends cut; behind it a table of 400 HU that is not in the truth.
/// Throws InvalidInput if spacing or samples are not positive or the noise is negative, and likewise below.
Phantom abdomen_phantom(const PhantomOptions& options = {});

/// A head about the origin of P in a cube of 128 mm, looking to -y: "skull" (closed shell of 6 mm),
/// "airway" (nostril of 2.5 mm radius, nasal passage, nasopharynx of 11 mm radius about (0, -5, -40), pharynx
/// that the lowest slices cut) and "wall" (soft tissue within 6 mm of the airway and 20 mm of that centre);
/// a head rest of 400 HU is not in the truth.
Phantom head_phantom(const PhantomOptions& options = {});

}  // namespace palpate
