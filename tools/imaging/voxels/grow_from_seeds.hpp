// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <span>
#include <string>

#include "formats/model/image_grid.hpp"
#include "formats/model/label_map.hpp"
#include "tools/imaging/voxels/seeds.hpp"

namespace palpate::imaging {

struct GrowParameters {
    double tolerance =
        3;  ///< a label stops at grey values more than this many of its deviations off its mean
    std::map<std::string, double> tolerances = {};  ///< of labels that have their own
    double spacing_mm = 0;  ///< works on blocks of voxels of about this size; 0 takes the volume's own voxels
};

/// Grows labels from seeds in competition: each voxel goes to the label that reaches it by the cheapest path,
/// the sum over its steps of length_mm * (0.1 + ((v - mean) / sigma)^2 + (dv / sigma)^2), with v the voxel's
/// grey value and dv its change along the step. A label's mean and sigma are those within 4 mm of its seeds
/// (median, and 1.48 times the median absolute deviation, at least 0.5 % of the volume's range of values).
/// One label alone takes whatever it reaches within its tolerance. Labels take the values 1, 2, ... in the
/// order in which they first occur; the label "background" competes at any grey value and stays 0.
/// The result lies on the volume's grid, whatever the spacing it was worked out on. Deterministic: one
/// thread, integer costs, ties to the seed given first.
/// Throws InvalidInput if there is no seed, or if one lies outside the volume (naming label and place).
/// Cost: linear in voxels (bucket queue); on 256 x 256 x 108 voxels, one core, 0.5 to 1.5 s at the volume's
/// own spacing and 0.1 s with preview_parameters().
/// Source: the shortest-path form of grow-cut (Zhu, Kolesov, Gao, Kikinis and Tannenbaum, 2014), with the
/// grey-value term that noisy CT needs.
LabelMap grow_from_seeds(const Volume& volume, std::span<const Seed> seeds,
                         const GrowParameters& parameters = {});

/// Makes grow_from_seeds() answer within a second for a volume on this grid: at most 400 000 blocks.
GrowParameters preview_parameters(const ImageGrid& grid);

}  // namespace palpate::imaging
