// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: whether slices make a grid, and what to do if they do not.
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "tools/imaging/files/image_files.hpp"

namespace palpate::imaging {

/// Where a slice lies, and what to call it.
struct SlicePlace {
    Eigen::Vector3d origin;  ///< p_P of its first voxel
    std::string name;
};

/// The first fault of a stack, in the words of an error; `found` is empty if there is none.
struct StackFault {
    std::string found, expected, next_step;
    double mean_gap = 0;  ///< mm
};

/// Looks for doubled, missing, unevenly spaced or sheared slices among `places`, which ascend along the unit
/// `normal`. Distances may differ by 2 % or 0.011 mm, which positions rounded to 0.01 mm reach; over the
/// whole stack slices may leave the even grid by half a `pixel` (mm) sideways and half a step along the
/// normal.
StackFault find_stack_fault(std::span<const SlicePlace> places, const Eigen::Vector3d& normal, double pixel);

/// Interpolates the slices of `volume`, which lie at `places` (ascending along the third direction), linearly
/// onto an even, untilted grid from the first to the last one, wide enough for all; outside the slices it
/// holds the lowest value. The step is the usual one, fitted to the length. Throws InvalidInput naming two
/// slices at one place whose voxels differ. A note says what was done.
Volume resample_stack(const Volume& volume, std::span<const SlicePlace> places,
                      const std::filesystem::path& path, const NoteSink& note);

}  // namespace palpate::imaging
