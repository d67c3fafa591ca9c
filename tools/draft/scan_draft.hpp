// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "formats/model/image_grid.hpp"
#include "formats/model/progress.hpp"
#include "tools/draft/case_draft.hpp"
#include "tools/draft/scan_recipes.hpp"
#include "tools/imaging/files/read_image.hpp"

namespace palpate::draft {

/// Where a person says that an organ is in a scan: points "x,y,z" (LPS, mm), or a file of them.
struct ScanSeeds {
    std::vector<std::string> inside, outside;
    std::filesystem::path file;  ///< empty: the points are written into the case
    std::string file_in_case;    ///< how the case file names it
};

/// Throws UsageError naming `option` unless a text is three finite numbers between commas.
void check_point(const std::string& text, const std::string& option);

/// A structure's text with points inside and around it.
std::string with_points(std::string structure, const std::vector<std::string>& inside,
                        const std::vector<std::string>& outside);

/// Drafts a case from a scan by segmenting it as the case will. `ct`: its values are HU, or lie a known
/// offset above. A file with points of 'background' lets an organ grow against them. Throws InvalidInput as
/// segment(), read_seeds() and draft_case() do, UsageError as scan_recipes().
CaseDraft draft_scan(const Volume& volume, bool ct, const ScanSeeds& seeds, const Wishes& wishes,
                     const std::string& culprit, const ProgressCallback& progress,
                     const imaging::NoteSink& note);

}  // namespace palpate::draft
