// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <vector>

#include "formats/model/label_map.hpp"
#include "tools/meshing/tetrahedra/tetrahedralise.hpp"

namespace palpate::mesh {

// All throw UsageError naming the option if the text is malformed; `culprit` is the label map's file, which
// require_label() names.

/// "tumour=4": a label and its cell size in mm; the label must be one of `regions`.
RegionSize parse_region_size(const std::string& text, const LabelMap& map,
                             const std::vector<std::int32_t>& regions, const std::string& culprit);

/// "tumour=3,10" or "12,-40,88=3,10": cells of 3 mm as far as 10 mm from a label or from a point.
NearSize parse_near(const std::string& text, const LabelMap& map, const std::string& culprit);

/// "4=tumour", once for each of an imported mesh's regions that is to have another name.
std::map<std::int32_t, std::string> parse_region_names(const std::vector<std::string>& texts);

}  // namespace palpate::mesh
