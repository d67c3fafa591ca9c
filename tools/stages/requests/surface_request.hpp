// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/cli/command.hpp"

namespace palpate::stages {

/// What `palpate surface` is asked for: an isosurface of a volume (masked by labels if there are any), the
/// outline of labels, or an imported surface.
struct SurfaceRequest {
    std::filesystem::path volume;
    std::optional<double> isovalue;        ///< HU for CT; with a volume
    std::filesystem::path labels;          ///< with label_names
    std::vector<std::string> label_names;  ///< or values
    std::filesystem::path surface_file;    ///< imported; then neither volume nor labels
    std::string unit = "mm", frame;        ///< of that file
    int mask_reach = 2;                    ///< voxels beyond its labels that the volume counts
    double smoothing = -1;                 ///< mm, Gaussian on labels; below 0: the largest voxel edge
    bool keep_largest = false;             ///< the piece of largest area only
    std::int64_t min_triangles = 100;      ///< of a piece that is kept
    std::int64_t max_triangles = 0;        ///< 0: not decimated
    double max_distance = 0;               ///< mm that decimation may move the surface; 0: any
    std::filesystem::path output;          ///< .vtp
};

/// Binds the options of `palpate surface`.
void declare(cli::Command& command, SurfaceRequest& request);

}  // namespace palpate::stages
