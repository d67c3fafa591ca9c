// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/draft/case_draft.hpp"

namespace palpate::commands {

/// What `palpate init` was told, by options or answers. Empty: not told.
struct InitRequest {
    std::filesystem::path input, output, seeds_file;
    std::string organ, label_names, approach, series;
    std::vector<std::string> seeds, background_seeds;
    bool labels = false, yes = false;
    double contact_nodes = 0, size_mib = 0;  ///< one of them, or neither
    /// HU = scale * value + offset, of a CT in other units.
    std::optional<double> scale;
    double offset = 0;
    bool scale_is_guessed = false;
};

/// What that means for a draft. Throws UsageError for an approach that is no side.
draft::Wishes wishes_of(const InitRequest& request);

/// Throws UsageError for a name of an organ that cannot be written into a case.
void check_name(const std::string& organ);

/// The command line that drafts the same and asks nothing, as a shell reads it.
std::string command_of(const InitRequest& request);

}  // namespace palpate::commands
