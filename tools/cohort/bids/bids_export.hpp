// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tools/cohort/cohort.hpp"

namespace palpate::cohort {

/// Whom a derivative dataset has.
struct BidsExport {
    std::vector<std::string> patients;
    std::vector<std::pair<std::string, std::string>> left_out;  ///< name and reason
    bool linked = false;                                        ///< whether it says which files it is from
};

/// Fills `folder` with a BIDS derivative dataset (BIDS 1.9) of all patients that are built as table and
/// inputs are now: of each, beside each other and named after the image that it is from, the structures
/// (_desc-palpate_dseg.nii.gz with .tsv and .json), the asset and the report. `output` is where the folder
/// will lie: inside the source dataset, Sources and SpatialReference lead there by a relative link, elsewhere
/// by its DOI if it has one, else nothing does. No path of this machine is written; the same cohort gives the
/// same bytes. `before_each` is called before each patient, with what part is done. Throws InvalidInput if
/// nobody is built, if an image is in no BIDS dataset or there is none, if they are in several datasets or in
/// one inside `output`, or if two patients' files would have the same names; SystemFailure if something
/// cannot be written.
BidsExport write_bids_dataset(const Cohort& cohort, const States& states, const std::filesystem::path& output,
                              const std::filesystem::path& folder,
                              const std::function<void(double)>& before_each);

/// Throws InvalidInput if `source`, of which `output` is made, is that folder or lies in it.
void require_outside(const std::filesystem::path& output, const std::filesystem::path& source);

/// Throws InvalidInput if `output` holds something that an export must not replace: anything but a dataset
/// that Palpate made.
void require_replaceable(const std::filesystem::path& output);

}  // namespace palpate::cohort
