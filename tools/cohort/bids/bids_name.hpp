// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate::cohort {

/// A file's name as BIDS takes it apart: "sub-01_run-2_T1w.nii.gz" has the entities sub=01 and run=2, the
/// suffix T1w and the extension ".nii.gz".
struct BidsName {
    std::vector<std::pair<std::string, std::string>> entities;  ///< in the name's order
    std::string suffix;
    std::string extension;  ///< from the first '.' on

    /// The value of an entity; empty if the name has none.
    std::string operator[](std::string_view entity) const;
    /// True if the name has every entity of `other`, with its value.
    bool has_all_of(const BidsName& other) const;
};

/// Takes a file's name apart; nothing if it is not made of "entity-value" parted by '_' and a suffix behind
/// them. `needs_suffix` false: what a person writes to choose a file, "acq-mprage" as well as
/// "acq-mprage_T1w".
std::optional<BidsName> parse_bids_name(std::string_view name, bool needs_suffix = true);

/// The file's name again.
std::string spelled(const BidsName& name);

}  // namespace palpate::cohort
