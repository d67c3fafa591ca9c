// SPDX-License-Identifier: GPL-3.0-or-later
// For tools/imaging only: where between two regions the border runs.
#pragma once
#include <vector>

#include "tools/imaging/voxels/mask.hpp"

namespace palpate::imaging {

/// What a random walker is told besides the grey values.
struct Walk {
    Mask inside, outside;      ///< voxels that are certain; where both say so, inside holds
    std::vector<float> prior;  ///< chance by grey value alone that a voxel is inside, 0 to 1, one per voxel
    double noise;              ///< standard deviation of the grey values within one tissue, above 0
    double trust_mm;           ///< length at which the prior weighs as much as the neighbours
};

/// Voxels from which a random walker more probably reaches `inside` than `outside`. It crosses from a voxel
/// to a face neighbour at distance h with weight exp(-d^2 / (4 noise^2)) / h^2, where d is the difference of
/// their grey values, whose variance within one tissue is 2 noise^2; and at each voxel it ends, with weight
/// 1 / trust_mm^2, inside with the chance that `prior` gives. So the border runs where grey values change
/// most, and where they do not, evenly between what is certain. Cost: a sparse system with one unknown per
/// voxel that is not certain, solved by conjugate gradients in one thread. Throws InvalidInput if noise,
/// trust or priors are not as told, SystemFailure if it does not converge. Source: Grady (2005), with the
/// priors of Grady (CVPR 2005).
Mask random_walk(const Volume& grey, const Walk& walk);

}  // namespace palpate::imaging
