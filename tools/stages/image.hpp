// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <optional>

#include "formats/model/progress.hpp"
#include "formats/model/scan.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/voxels/label_statistics.hpp"
#include "tools/stages/requests/import_request.hpp"

namespace palpate::stages {

/// A grid: size, spacing and origin in mm, directions column by column; LPS.
nlohmann::ordered_json to_json(const ImageGrid& grid);

/// What a case's scan is like: voxels along i, j, k, their size, what values are; null without one.
nlohmann::ordered_json scan_json(const std::optional<Scan>& scan);

/// One label of a map: volume in ml, the box and the centroid of its voxel centres in LPS mm.
nlohmann::ordered_json to_json(const imaging::LabelStatistics& label);

/// Throws UsageError for what a request asks of an input that has no such thing, and unless it either lists
/// or names an output.
void check_request(const ImportRequest& request);

/// How to read the request's input. Throws UsageError for an unknown word.
imaging::ReadOptions read_options_of(const ImportRequest& request);

/// Reads the request's volume or label map as `options` say, names its labels and writes it to `file`;
/// returns the grid, and the labels or the range of values. Throws as read_volume(), read_label_map() and
/// name_labels() do.
nlohmann::ordered_json import_image(const ImportRequest& request, const imaging::ReadOptions& options,
                                    const std::filesystem::path& file, const ProgressCallback& progress,
                                    const imaging::NoteSink& note);

}  // namespace palpate::stages
