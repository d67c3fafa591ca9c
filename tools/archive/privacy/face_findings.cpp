// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/asset/asset.hpp"
#include "formats/model/errors.hpp"
#include "tools/archive/privacy/searches.hpp"
#include "tools/imaging/faces/face.hpp"
#include "tools/imaging/files/image_files.hpp"

namespace palpate::archive {
namespace {

constexpr auto face = "soft tissue in front of a head's bone";

// A face is the same in both of a NIfTI file's frames, whether they agree or not.
Volume read_in_any_frame(const std::filesystem::path& file) {
    imaging::ReadOptions options;
    if (imaging::is_nifti(file)) options.nifti_frame = "sform";
    try {
        return imaging::read_volume(file);
    } catch (const InvalidInput&) {
        return imaging::read_volume(file, {}, options);
    }
}

}  // namespace

void search_volume_face(const std::filesystem::path& file, Findings& findings) {
    try {
        if (imaging::shows_face(read_in_any_frame(file)))
            findings.push_back({file, "its voxels", "face", face});
    } catch (const InvalidInput& refusal) {
        findings.push_back({file, "its voxels", "not looked at", shortened(refusal.detail().found)});
    }
}

void search_asset_face(const std::filesystem::path& file, Findings& findings) {
    try {
        const Case patient_case = asset::read_asset(file);
        if (patient_case.scan && imaging::shows_face(*patient_case.scan))
            findings.push_back({file, "its scan", "face", face});
    } catch (const InvalidInput& refusal) {
        findings.push_back({file, "its scan", "not looked at", shortened(refusal.detail().found)});
    }
}

}  // namespace palpate::archive
