// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <vector>

#include "tools/imaging/voxels/seeds.hpp"
#include "tools/seeds/slice_view.hpp"

namespace palpate::seeds {

/// What a person has done so far; drawing and growing look at it, the functions below change it.
struct SeedState {
    std::vector<std::string> labels{"background"};   ///< by number key: 0 is "background", 1 ... 9 structures
    std::size_t active = 0;                          ///< of `labels`
    std::vector<imaging::Seed> seeds;                ///< in the order placed
    std::vector<imaging::Seed> saved;                ///< as last written or read
    std::vector<std::vector<imaging::Seed>> past;    ///< seeds before each change, latest last
    std::array<std::int32_t, 3> crosshair{0, 0, 0};  ///< voxel in which the three slices meet
};

/// A state for `labels` (structures) and seeds read earlier, whose labels are added; the crosshair is in the
/// last of those seeds, else in the middle of the grid. Throws UsageError for more than nine structures.
SeedState start_state(const ImageGrid& grid, const std::vector<std::string>& labels,
                      const std::vector<imaging::Seed>& seeds);

/// Places a seed of the active label at a continuous voxel index and moves the crosshair there.
void place_seed(SeedState& state, const ImageGrid& grid, const Eigen::Vector3d& index);

/// Removes the seed nearest to p_P if one lies within `radius` (mm); tells whether it did.
bool remove_nearest(SeedState& state, const Eigen::Vector3d& p_P, double radius);

/// Removes the seed placed last; tells whether there was one.
bool remove_last(SeedState& state);

/// Takes back the last placing or removing; tells whether there was one.
bool undo(SeedState& state);

/// Makes the label of a number key active; tells whether there is one.
bool choose_label(SeedState& state, std::size_t number);

/// Moves the crosshair to the voxel at a continuous index, clamped to the grid.
void move_crosshair(SeedState& state, const ImageGrid& grid, const Eigen::Vector3d& index);

/// Moves a view's slice by `steps` away from the viewer, clamped to the grid.
void scroll(SeedState& state, const ImageGrid& grid, const SliceView& view, int steps);

/// Colour of a label by its number: bright, apart from each other and from grey; grey for the background.
std::array<float, 3> label_colour(std::size_t number);

/// Tells whether the seeds differ from those last written or read.
bool unsaved(const SeedState& state);

}  // namespace palpate::seeds
