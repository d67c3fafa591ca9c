// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "tools/cohort/bids/bids_folder.hpp"

namespace palpate::cohort {

/// A subject's discrete segmentation, or why there is none.
struct ChosenSegmentation {
    std::filesystem::path labels;       ///< *_dseg.nii.gz; empty if there is not one
    std::filesystem::path label_table;  ///< the dseg.tsv that names its values; empty if not one does
    std::string problem;                ///< and the remedy
};

/// Where segmentations are looked for: in `derivatives` if it is given, else in the dataset itself and in
/// each folder of its derivatives/ that Palpate did not make. Throws InvalidInput if `derivatives` is no
/// folder.
std::vector<std::filesystem::path> segmentation_folders(const std::filesystem::path& dataset,
                                                        const std::filesystem::path& derivatives);

/// The one segmentation of `image` in the folders' `below` ("sub-01/ses-02"): suffix dseg, in the image's own
/// space, no entity of the acquisition (acq, run, ...) with another value than the image has, and all that
/// `wanted` has, "seg-organs". Its names come from the dseg.tsv that BIDS' inheritance principle gives it: in
/// its folder or one above, no entity that it has not, the nearest and then the most specific; of several
/// such none, which is a problem.
ChosenSegmentation choose_segmentation(std::span<const std::filesystem::path> folders,
                                       const std::filesystem::path& below, const BidsName& image,
                                       const BidsName& wanted);

}  // namespace palpate::cohort
