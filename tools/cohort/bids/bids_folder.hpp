// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/cohort/bids/bids_name.hpp"

namespace palpate::cohort {

/// A file of a BIDS dataset.
struct BidsFile {
    std::filesystem::path path;  ///< from the dataset's folder: "sub-01/anat/sub-01_T1w.nii.gz"
    BidsName name;
};

/// Tells whether a file is there, links followed. Throws SystemFailure if that cannot be known.
bool is_there(const std::filesystem::path& path);

/// What is in a folder, by name; nothing if there is no such folder. Throws SystemFailure if it cannot be
/// read.
std::vector<std::filesystem::path> entries_in(const std::filesystem::path& folder);

/// Tells whether a folder is a BIDS dataset, by its dataset_description.json. Throws as is_there().
bool is_bids_dataset(const std::filesystem::path& folder);

/// A dataset's dataset_description.json. Throws InvalidInput if it is missing, no JSON object or longer than
/// 16 MiB.
nlohmann::json dataset_description(const std::filesystem::path& dataset);

/// Tells whether a dataset_description.json says that Palpate, and nobody else, made the dataset.
bool is_ours(const nlohmann::json& description);

/// The folders in `folder` whose names begin with `prefix`, "sub-", by name; none if it is no folder.
std::vector<std::string> folders_in(const std::filesystem::path& folder, const std::string& prefix);

/// The images (.nii, .nii.gz) of a subject or session by path: of "sub-01/ses-02" those in its folders anat
/// and ct whose names begin with "sub-01_ses-02_". Links count, whether they lead anywhere or not.
std::vector<BidsFile> images_in(const std::filesystem::path& dataset, const std::filesystem::path& below);

/// What files of "sub-01/ses-02" begin with, "sub-01_ses-02".
std::string patient_name(const std::filesystem::path& below);

/// Tells whether an image lies in its subject's own space: its name has no `space`, or that is "orig" or
/// `own`, the suffix of the subject's image.
bool in_own_space(const BidsName& name, const std::string& own);

}  // namespace palpate::cohort
