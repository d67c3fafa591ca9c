// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace palpate::cohort {

/// What is taken of a BIDS dataset that has several.
struct BidsChoice {
    std::string image;                  ///< suffix and entities, "T2w" or "acq-mprage_T1w"; empty: see below
    std::string segmentation;           ///< entities, "seg-organs"; empty: the only one
    std::filesystem::path derivatives;  ///< dataset of the segmentations; empty: see segmentation_folders()
};

/// Writes the table of patients that read_patient_table() takes, a row for each subject, or session of one,
/// of a BIDS dataset, as text; `folder` is where it will lie, paths are relative to it, or absolute if it is
/// empty. The image is that of the suffix which most subjects have, of equals the first of T1w, T2w, FLAIR,
/// PDw, T2starw, UNIT1 and ct; of several runs the first; in no other space than the subject's. Where the
/// case takes a label map, a segmentation as choose_segmentation() finds it, with its names. A row that has
/// not one of each says so in its column `problem`, with the remedy; sessions without image are left out
/// where another session has one. `note` receives what was chosen, a sentence at a time. Throws InvalidInput
/// for a folder that is no BIDS dataset or has no subject or no such image at all, and what read_case_file()
/// throws for the case file. Cost: it lists the folders anat and ct of every subject; no image is read.
std::string bids_patient_table(const std::filesystem::path& dataset, const std::filesystem::path& case_file,
                               const std::filesystem::path& folder, const BidsChoice& choice,
                               const std::function<void(std::string_view)>& note);

}  // namespace palpate::cohort
