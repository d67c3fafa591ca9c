// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "formats/asset/asset.hpp"
#include "formats/model/errors.hpp"
#include "tools/archive/privacy/searches.hpp"
#include "tools/imaging/faces/face.hpp"
#include "tools/imaging/files/image_files.hpp"

namespace palpate::archive {
namespace {

// The voxels of a file, as a volume; none if it holds none.
Volume voxels_of(const std::filesystem::path& file) {
    if (file.extension() != ".vtkhdf") return imaging::read_volume(file);
    const Case patient_case = asset::read_asset(file);
    if (!patient_case.scan || !patient_case.scan->hounsfield) return {};
    return {patient_case.scan->grid, {patient_case.scan->values.begin(), patient_case.scan->values.end()}};
}

}  // namespace

void search_face(const std::filesystem::path& file, Findings& findings) {
    try {
        const Volume volume = voxels_of(file);
        if (!volume.values.empty() && imaging::shows_face(volume))
            findings.push_back({file, "its voxels", "face", "soft tissue in front of a head's bone"});
    } catch (const InvalidInput&) {
    }
}

}  // namespace palpate::archive
