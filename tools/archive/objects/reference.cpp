// SPDX-License-Identifier: GPL-3.0-or-later
// DCMTK's headers first: its configuration macros must not be seen twice.
#include "tools/archive/objects/reference.hpp"

#include <algorithm>
#include <cmath>
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <fmt/format.h>

#include "formats/model/errors.hpp"

namespace palpate::archive {
namespace {

std::string value_of(DcmItem& item, const DcmTagKey& key) {
    OFString value;
    item.findAndGetOFStringArray(key, value);
    return {value.c_str(), value.size()};
}

// What an archive files a study by.
const std::vector<DcmTagKey>& identity_attributes() {
    static const std::vector<DcmTagKey> keys{DCM_PatientName,      DCM_PatientID,  DCM_IssuerOfPatientID,
                                             DCM_PatientBirthDate, DCM_PatientSex, DCM_StudyDate,
                                             DCM_StudyTime,        DCM_StudyID,    DCM_AccessionNumber};
    return keys;
}

void take_study(Reference& reference, DcmDataset& data, const std::filesystem::path& path) {
    reference.study_uid = value_of(data, DCM_StudyInstanceUID);
    reference.series_uid = value_of(data, DCM_SeriesInstanceUID);
    reference.frame_of_reference_uid = value_of(data, DCM_FrameOfReferenceUID);
    const auto require = [&](const std::string& uid, const std::string& name) {
        if (uid.empty())
            throw InvalidInput({path.string(), "has no " + name, "a series as a scanner or archive made it",
                                "leave --reference out, or name the original series"});
    };
    require(reference.study_uid, "StudyInstanceUID");
    require(reference.series_uid, "SeriesInstanceUID");
    for (const DcmTagKey& key : identity_attributes())
        if (const std::string value = value_of(data, key); !value.empty())
            reference.identity[{key.getGroup(), key.getElement()}] = value;
}

std::string figures(const Eigen::Vector3d& v) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", v[0], v[1], v[2]);
}

std::string figures(const ImageGrid& grid) {
    return fmt::format(
        "{} x {} x {} voxels of {:.6g} x {:.6g} x {:.6g} mm, first at {}, i along {}, j along {}",
        grid.size[0], grid.size[1], grid.size[2], grid.spacing[0], grid.spacing[1], grid.spacing[2],
        figures(grid.origin), figures(grid.direction.col(0)), figures(grid.direction.col(1)));
}

}  // namespace

Reference read_reference(const std::filesystem::path& path, const imaging::ReadOptions& options,
                         const imaging::NoteSink& note) {
    const imaging::PlacedSeries places = imaging::read_dicom_places(path, note, options);
    Reference reference;
    reference.grid = places.grid;
    for (const imaging::PlacedSlice& slice : places.slices) {
        DcmFileFormat file;
        if (file.loadFile(slice.file.c_str()).bad())
            throw InvalidInput({slice.file, "cannot be read", "DICOM", "copy the file again"});
        DcmDataset& data = *file.getDataset();
        if (reference.slices.empty()) {
            static_cast<void>(data.convertToUTF8());  // else values stay as the file has them
            take_study(reference, data, path);
        }
        ReferenceSlice found{value_of(data, DCM_SOPClassUID), value_of(data, DCM_SOPInstanceUID), 0,
                             slice.origin};
        if (found.sop_class.empty() || found.sop_instance.empty())
            throw InvalidInput({slice.file, "has no SOPInstanceUID", "a slice as a scanner made it",
                                "leave --reference out, or name the original series"});
        if (!value_of(data, DCM_NumberOfFrames).empty()) found.frame = static_cast<int>(slice.frame) + 1;
        reference.slices.push_back(found);
    }
    return reference;
}

void require_fit(const ImageGrid& labels, const Reference& reference, const std::string& culprit) {
    const ImageGrid& grid = reference.grid;
    const double pixel = grid.spacing.head<2>().minCoeff(), tolerance = pixel / 20;
    double shift = 0;  // mm within the plane, at any corner
    for (const int i : {0, labels.size[0] - 1})
        for (const int j : {0, labels.size[1] - 1})
            for (const int k : {0, labels.size[2] - 1}) {
                const Eigen::Vector3d off =
                    grid.index_of(labels.point_of(Eigen::Vector3d(i, j, k))) - Eigen::Vector3d(i, j, 0);
                shift = std::max(shift, std::hypot(off[0] * grid.spacing[0], off[1] * grid.spacing[1]));
            }
    const double first = grid.index_of(labels.origin)[2],
                 last = grid.index_of(labels.point_of(Eigen::Vector3d(0, 0, labels.size[2] - 1)))[2];
    const bool within = std::min(first, last) > -0.5 && std::max(first, last) < grid.size[2] - 0.5;
    if (labels.size[0] == grid.size[0] && labels.size[1] == grid.size[1] && shift <= tolerance && within)
        return;
    throw InvalidInput({culprit,
                        fmt::format("{}; its columns and rows lie up to {:.3g} mm off the reference's, its "
                                    "slices at {:.3g} ... {:.3g} of them",
                                    figures(labels), shift, first, last),
                        "slices of the reference, " + figures(grid),
                        "name the series that the label map was made from, or leave --reference out"});
}

void require_inside(const std::vector<Eigen::Vector3d>& points_P, const Reference& reference,
                    const std::string& culprit) {
    const ImageGrid& grid = reference.grid;
    for (const Eigen::Vector3d& point : points_P) {
        const Eigen::Vector3d index = grid.index_of(point);
        for (int axis = 0; axis < 3; ++axis)
            if (!(index[axis] >= -1.5 && index[axis] <= grid.size[axis] + 0.5))
                throw InvalidInput(
                    {culprit,
                     fmt::format("reaches {}, voxel {} of the reference", figures(point), figures(index)),
                     "a surface within " + figures(grid),
                     "name the series that the surface was made from, state --unit and "
                     "--frame, or leave --reference out"});
    }
}

}  // namespace palpate::archive
