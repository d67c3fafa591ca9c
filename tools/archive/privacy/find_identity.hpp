// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <vector>

#include "tools/archive/privacy/finding.hpp"
#include "tools/archive/privacy/machine.hpp"

namespace palpate::archive {

/// What was searched, and what was found.
struct PrivacyReport {
    std::size_t files = 0;
    std::vector<Finding> findings;
};

/// Searches files, and all files below folders, for what tells a patient, a person, this machine or a place
/// on its disk: DICOM by the basic profile of PS3.15 and by the type of attributes, HDF5 by names, attributes
/// and strings, NIfTI, NRRD and MetaImage by the fields of their headers, texts line by line, the text before
/// appended data in VTK's files, anything else for user, host and paths only. In a volume's or an asset's CT
/// it looks for a face; DICOM slices, MRI, drawn pictures and names burnt into pixels are not looked at.
/// Throws InvalidInput for what cannot be read whole: what was not searched is not clean. Cost: linear in
/// bytes.
PrivacyReport find_identity(const std::vector<std::filesystem::path>& paths, const Machine& machine);

}  // namespace palpate::archive
