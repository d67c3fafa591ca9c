// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "formats/model/label_map.hpp"

namespace palpate::fuzz {

/// Writes small inputs of the DICOM target into `folder`: series, plain and compressed, one file of several
/// frames, and what `palpate export` makes of `map` and of a surface.
void write_dicom_samples(const std::filesystem::path& folder, const LabelMap& map);

}  // namespace palpate::fuzz
