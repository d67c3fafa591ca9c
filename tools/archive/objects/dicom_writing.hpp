// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: what both objects write alike. To be included after DCMTK's osconfig.h.
#pragma once
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <filesystem>
#include <string>

#include "tools/archive/objects/archive_objects.hpp"
#include "tools/archive/objects/segment_codes.hpp"

namespace palpate::archive {

/// Sets one attribute; throws SystemFailure if DCMTK refuses.
void put(DcmItem& item, const DcmTagKey& key, const std::string& value);
void put(DcmItem& item, const DcmTagKey& key, Uint16 value);

/// Appends an item to a sequence, which is made as needed.
DcmItem& add_item(DcmItem& item, const DcmTagKey& sequence);
void add_code(DcmItem& item, const DcmTagKey& sequence, const Code& code);

/// A number in the 16 characters that DICOM gives it (VR DS), as near as they come.
std::string decimal(double value);

/// Throws InvalidInput unless a text has at most 64 characters and none that DICOM takes for its own (VR LO).
void require_short_text(const std::string& text, const std::string& what, const std::string& culprit);

/// Writes patient, study, series, frame of reference, equipment and instance.
void put_header(DcmItem& item, const Filing& filing, const std::string& digest, const char* sop_class,
                const std::string& modality, std::string_view description);

/// Appends an item to a sequence for each file of the reference.
void add_instances(DcmItem& item, const DcmTagKey& sequence, const Reference& reference);

/// Writes the whole file, explicit little endian; throws SystemFailure.
void save_object(const std::filesystem::path& path, DcmFileFormat& file);

}  // namespace palpate::archive
