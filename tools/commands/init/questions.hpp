// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/image_grid.hpp"
#include "formats/model/label_map.hpp"
#include "tools/cli/question.hpp"
#include "tools/commands/init/request.hpp"
#include "tools/draft/scan_recipes.hpp"

namespace palpate::commands {

// What a person at a terminal is asked that no option said; each writes its answer to the request. Where
// nobody is asked, the request stays as it is, or gets what is proposed.

/// Which of several series of a DICOM folder: proposed is the one that has the most slices.
void ask_series(InitRequest& request, cli::Questions& questions);

/// Which structure of a label map gives way.
void ask_organ(InitRequest& request, const LabelMap& map, cli::Questions& questions);

/// Which organ is to be found in a scan, a nasopharynx where a CT shows a head and a liver elsewhere. Throws
/// UsageError where nobody is asked and the values are no HU.
void ask_organ(InitRequest& request, const Volume& volume, bool ct, cli::Questions& questions);

/// By which scale the values of what seems to be a CT in other units are HU: proposed is what its air and
/// soft tissue say, which is taken where nobody is asked.
void ask_scale(InitRequest& request, const Volume& volume, cli::Questions& questions);

/// What a surface is; proposed is the file's name.
void ask_name(InitRequest& request, cli::Questions& questions);

/// Where the tool comes from.
void ask_approach(InitRequest& request, cli::Questions& questions);

/// What the compliance may take.
void ask_size(InitRequest& request, cli::Questions& questions);

/// A point in what is clicked into, where there is no display to click one.
void ask_seed(InitRequest& request, const draft::ScanRecipes& recipes, cli::Questions& questions);

}  // namespace palpate::commands
