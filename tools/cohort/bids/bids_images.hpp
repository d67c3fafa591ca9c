// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cohort/bids/bids_folder.hpp"

namespace palpate::cohort {

/// A subject, or one of his sessions.
struct Scan {
    std::string subject;           ///< "sub-01"
    std::filesystem::path below;   ///< "sub-01/ses-02"
    std::vector<BidsFile> images;  ///< all of images_in()
};

/// A scan's image, or why there is none.
struct ChosenImage {
    std::optional<BidsFile> file;
    std::string problem;  ///< and the remedy; empty if there is a file
    std::string note;     ///< what it was chosen from; empty if there was no choice
};

/// Every subject, or each session of one, by name. Throws InvalidInput if there is none.
std::vector<Scan> scans_of(const std::filesystem::path& dataset);

/// What to look for: `wanted` with its suffix, or else with the one that most subjects have, of equals the
/// first of T1w, T2w, FLAIR, PDw, T2starw, UNIT1 and ct. `note` is told where there are others.
BidsName image_of_most(std::span<const Scan> scans, BidsName wanted,
                       const std::function<void(std::string_view)>& note);

/// The scans but for sessions without a `wanted` image. Of a subject whose sessions all lack it one scan
/// stays, named as the subject alone; `note` is told of the other subjects' sessions.
std::vector<Scan> with_images(std::span<const Scan> scans, const BidsName& wanted,
                              const std::function<void(std::string_view)>& note);

/// The image with the suffix and the entities of `wanted`, in its subject's own space unless `wanted` names
/// another; of several that differ in `run` alone the first.
ChosenImage choose_image(const Scan& scan, const BidsName& wanted);

}  // namespace palpate::cohort
