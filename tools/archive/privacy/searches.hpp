// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: the searches that find_identity() sends files to, by what they are.
#pragma once
#include <string_view>

#include "tools/archive/privacy/finding.hpp"
#include "tools/archive/privacy/machine.hpp"

namespace palpate::archive {

using Findings = std::vector<Finding>;

/// Searches one text, of a field or a whole file, for paths, user and host names, e-mail addresses, dates of
/// birth, names as DICOM writes them, fields named as a patient's, and UIDs. `where` is told as it is, or
/// with the line if `lines`.
void search_text(std::string_view text, const std::filesystem::path& file, const std::string& where,
                 bool lines, const Machine& machine, Findings& findings);

/// Searches bytes that are no text for user and host names and paths only: anything shorter stands there by
/// chance.
void search_bytes(std::string_view bytes, const std::filesystem::path& file, const Machine& machine,
                  Findings& findings);

/// Searches the attributes of a DICOM file, nested ones too; false if it cannot be read.
bool search_dicom(const std::filesystem::path& file, const Machine& machine, Findings& findings);

/// Searches names, attributes and texts of an HDF5 file; false if it cannot be read.
bool search_hdf5(const std::filesystem::path& file, const Machine& machine, Findings& findings);

/// Search the header of a NIfTI file, given its unpacked bytes, and of a NRRD or MetaImage file; free text
/// in them is a finding whatever it says.
void search_nifti(std::string_view bytes, const std::filesystem::path& file, const Machine& machine,
                  Findings& findings);
void search_nrrd(std::string_view bytes, const std::filesystem::path& file, const Machine& machine,
                 Findings& findings);
void search_metaimage(std::string_view bytes, const std::filesystem::path& file, const Machine& machine,
                      Findings& findings);

/// Looks for a face in the voxels of a volume; one that cannot be read is a finding, too.
void search_volume_face(const std::filesystem::path& file, Findings& findings);

/// Looks for a face in the scan of an asset, likewise.
void search_asset_face(const std::filesystem::path& file, Findings& findings);

}  // namespace palpate::archive
