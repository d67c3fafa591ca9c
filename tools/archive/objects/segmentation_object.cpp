// SPDX-License-Identifier: GPL-3.0-or-later
// DCMTK's headers first: its configuration macros must not be seen twice.
#include <algorithm>
#include <cmath>
#include <dcmtk/dcmiod/cielabutil.h>
#include <fmt/format.h>
#include <numeric>
#include <span>

#include "formats/asset/hdf5/digest.hpp"
#include "formats/model/errors.hpp"
#include "tools/archive/objects/dicom_uid.hpp"
#include "tools/archive/objects/dicom_writing.hpp"
#include "tools/archive/objects/placeholders.hpp"

namespace palpate::archive {
namespace {

const Code segmentation_code{"113076", "DCM", "Segmentation"};
const Code source_image_code{"121322", "DCM", "Source image for image processing operation"};

// One frame: a segment on a slice.
struct SegmentFrame {
    std::size_t segment = 0;  // index in the map's names
    std::int32_t k = 0;
};

std::string content_digest(const LabelMap& map, const Filing& filing) {
    std::string text =
        fmt::format("segmentation {} {} {}", filing.version, filing.algorithm_type, filing.algorithm_name);
    const ImageGrid& grid = map.grid;
    text += fmt::format(" {} {} {}", grid.size[0], grid.size[1], grid.size[2]);
    for (const double value :
         {grid.spacing[0], grid.spacing[1], grid.spacing[2], grid.origin[0], grid.origin[1], grid.origin[2]})
        text += fmt::format(" {:.17g}", value);
    for (const double value : grid.direction.reshaped()) text += fmt::format(" {:.17g}", value);
    for (const Label& label : map.names)
        text += fmt::format("\n{} {} {} {} {}", label.value, label.name, label.colour[0], label.colour[1],
                            label.colour[2]);
    if (filing.reference) text += fmt::format("\n{} {}", filing.reference->series_uid, filing.identity);
    return asset::sha256(text + "\n" + asset::sha256(std::as_bytes(std::span(map.labels))));
}

void put_segments(DcmItem& data, const LabelMap& map, const Filing& filing, const std::string& culprit) {
    for (std::size_t n = 0; n < map.names.size(); ++n) {
        const Label& label = map.names[n];
        require_short_text(label.name, fmt::format("label {} is called", label.value), culprit);
        DcmItem& segment = add_item(data, DCM_SegmentSequence);
        put(segment, DCM_SegmentNumber, static_cast<Uint16>(n + 1));
        put(segment, DCM_SegmentLabel, label.name);
        put(segment, DCM_SegmentAlgorithmType, filing.algorithm_type);
        if (filing.algorithm_type != "MANUAL") put(segment, DCM_SegmentAlgorithmName, filing.algorithm_name);
        const SegmentCodes codes = codes_of(label.name);
        add_code(segment, DCM_SegmentedPropertyCategoryCodeSequence, codes.category);
        add_code(segment, DCM_SegmentedPropertyTypeCodeSequence, codes.type);
        if (codes.side) {
            DcmItem* type = nullptr;
            segment.findOrCreateSequenceItem(DCM_SegmentedPropertyTypeCodeSequence, type, 0);
            add_code(*type, DCM_SegmentedPropertyTypeModifierCodeSequence, *codes.side);
        }
        std::array<double, 3> lab{};
        IODCIELabUtil::rgb2DicomLab(lab[0], lab[1], lab[2], label.colour[0], label.colour[1],
                                    label.colour[2]);
        std::array<Uint16, 3> rounded{};
        std::ranges::transform(lab, rounded.begin(), [](double value) {
            return static_cast<Uint16>(std::lround(std::clamp(value, 0.0, 65535.0)));
        });
        segment.putAndInsertUint16Array(DCM_RecommendedDisplayCIELabValue, rounded.data(), 3);
    }
}

void put_shared_groups(DcmItem& data, const ImageGrid& grid) {
    DcmItem& shared = add_item(data, DCM_SharedFunctionalGroupsSequence);
    std::string directions;
    for (const double value : grid.direction.leftCols<2>().reshaped())
        directions += (directions.empty() ? "" : "\\") + decimal(value);
    put(add_item(shared, DCM_PlaneOrientationSequence), DCM_ImageOrientationPatient, directions);
    DcmItem& measures = add_item(shared, DCM_PixelMeasuresSequence);
    put(measures, DCM_SliceThickness, decimal(grid.spacing[2]));
    put(measures, DCM_SpacingBetweenSlices, decimal(grid.spacing[2]));
    put(measures, DCM_PixelSpacing, decimal(grid.spacing[1]) + "\\" + decimal(grid.spacing[0]));
}

void put_source(DcmItem& frame, const Eigen::Vector3d& origin, const Filing& filing, double spacing) {
    if (!filing.reference) return;
    for (const ReferenceSlice& slice : filing.reference->slices) {
        if ((slice.origin - origin).norm() > spacing / 20) continue;
        DcmItem& derivation = add_item(frame, DCM_DerivationImageSequence);
        add_code(derivation, DCM_DerivationCodeSequence, segmentation_code);
        DcmItem& source = add_item(derivation, DCM_SourceImageSequence);
        put(source, DCM_ReferencedSOPClassUID, slice.sop_class);
        put(source, DCM_ReferencedSOPInstanceUID, slice.sop_instance);
        if (slice.frame > 0) put(source, DCM_ReferencedFrameNumber, std::to_string(slice.frame));
        put(source, DCM_SpatialLocationsPreserved, "YES");
        add_code(source, DCM_PurposeOfReferenceCodeSequence, source_image_code);
        return;
    }
}

void put_dimensions(DcmItem& data, const std::string& digest) {
    const std::string uid = uid_of(digest, "dimensions");
    put(add_item(data, DCM_DimensionOrganizationSequence), DCM_DimensionOrganizationUID, uid);
    const auto add = [&](const DcmTagKey& pointer, const DcmTagKey& group) {
        DcmItem& index = add_item(data, DCM_DimensionIndexSequence);
        put(index, DCM_DimensionOrganizationUID, uid);
        index.putAndInsertTagKey(DCM_DimensionIndexPointer, pointer);
        index.putAndInsertTagKey(DCM_FunctionalGroupPointer, group);
    };
    add(DCM_ReferencedSegmentNumber, DCM_SegmentIdentificationSequence);
    add(DCM_ImagePositionPatient, DCM_PlanePositionSequence);
}

void put_frame_groups(DcmItem& data, const SegmentFrame& at, const ImageGrid& grid, const Filing& filing) {
    DcmItem& frame = add_item(data, DCM_PerFrameFunctionalGroupsSequence);
    const Eigen::Vector3d origin = grid.point_of(Eigen::Vector3d(0, 0, at.k));
    put_source(frame, origin, filing, grid.spacing[2]);
    const std::array<Uint32, 2> index{static_cast<Uint32>(at.segment + 1), static_cast<Uint32>(at.k + 1)};
    add_item(frame, DCM_FrameContentSequence)
        .putAndInsertUint32Array(DCM_DimensionIndexValues, index.data(), 2);
    put(add_item(frame, DCM_PlanePositionSequence), DCM_ImagePositionPatient,
        decimal(origin[0]) + "\\" + decimal(origin[1]) + "\\" + decimal(origin[2]));
    put(add_item(frame, DCM_SegmentIdentificationSequence), DCM_ReferencedSegmentNumber,
        static_cast<Uint16>(at.segment + 1));
}

// By segment, then by slice.
std::vector<SegmentFrame> frames_of(const LabelMap& map) {
    const std::size_t plane = map.labels.size() / static_cast<std::size_t>(map.grid.size[2]);
    std::vector<std::vector<bool>> occurs(static_cast<std::size_t>(map.grid.size[2]),
                                          std::vector<bool>(65536, false));
    for (std::size_t n = 0; n < map.labels.size(); ++n) occurs[n / plane][map.labels[n]] = true;
    std::vector<SegmentFrame> frames;
    for (std::size_t segment = 0; segment < map.names.size(); ++segment)
        for (std::int32_t k = 0; k < map.grid.size[2]; ++k)
            if (segment == 0 ||
                occurs[static_cast<std::size_t>(k)][static_cast<std::size_t>(map.names[segment].value)])
                frames.push_back({segment, k});
    return frames;
}

// Frames follow each other bit by bit (PS3.5 8.1.1).
std::vector<Uint8> packed_frames(const LabelMap& map, const std::vector<SegmentFrame>& frames) {
    const std::size_t plane = map.labels.size() / static_cast<std::size_t>(map.grid.size[2]);
    std::vector<Uint8> bits((frames.size() * plane + 15) / 16 * 2, 0);  // of even length
    std::size_t bit = 0;
    for (const SegmentFrame& frame : frames) {
        const std::uint16_t* voxels = map.labels.data() + static_cast<std::size_t>(frame.k) * plane;
        for (std::size_t n = 0; n < plane; ++n, ++bit)
            if (voxels[n] == map.names[frame.segment].value)
                bits[bit / 8] = static_cast<Uint8>(bits[bit / 8] | 1U << bit % 8);
    }
    return bits;
}

}  // namespace

LabelMap along_reference(const LabelMap& map, const Reference* reference, const std::string& culprit) {
    Eigen::Matrix3d axes = map.grid.direction;
    if (reference != nullptr)
        axes = reference->grid.direction;
    else if (axes.determinant() < 0)
        axes.col(2) *= -1;
    const Eigen::Matrix3d turn = map.grid.direction.transpose() * axes;  // signed permutation
    const Eigen::Matrix3d rounded = turn.array().round();
    if ((turn - rounded).cwiseAbs().maxCoeff() > 1e-3 ||
        (rounded.cwiseAbs().rowwise().sum().array() != 1).any())
        throw InvalidInput(
            {culprit,
             fmt::format("its axes are turned by up to {:.3g} degrees against the reference's",
                         std::acos(std::clamp(turn.cwiseAbs().colwise().maxCoeff().minCoeff(), 0.0, 1.0)) *
                             180 / EIGEN_PI),
             "axes parallel to the reference's",
             "name the series that the label map was made from, or leave --reference out"});
    if (rounded.isIdentity()) return map;
    LabelMap turned{map.grid, std::vector<std::uint16_t>(map.labels.size()), map.names};
    std::array<int, 3> from{};
    Eigen::Vector3d first = Eigen::Vector3d::Zero();  // index in the old map of the new one's first voxel
    for (int axis = 0; axis < 3; ++axis) {
        rounded.col(axis).cwiseAbs().maxCoeff(&from[axis]);
        turned.grid.size[axis] = map.grid.size[from[axis]];
        turned.grid.spacing[axis] = map.grid.spacing[from[axis]];
        turned.grid.direction.col(axis) = map.grid.direction.col(from[axis]) * rounded(from[axis], axis);
        if (rounded(from[axis], axis) < 0) first[from[axis]] = map.grid.size[from[axis]] - 1;
    }
    turned.grid.origin = map.grid.point_of(first);
    std::size_t n = 0;
    for (int k = 0; k < turned.grid.size[2]; ++k)
        for (int j = 0; j < turned.grid.size[1]; ++j)
            for (int i = 0; i < turned.grid.size[0]; ++i) {
                const Eigen::Vector3i old =
                    (first + rounded * Eigen::Vector3d(i, j, k)).array().round().cast<int>();
                turned.labels[n++] = map.labels[map.grid.offset(old[0], old[1], old[2])];
            }
    return turned;
}

void write_segmentation_object(const std::filesystem::path& path, const LabelMap& map, const Filing& filing,
                               const std::string& culprit) {
    if (map.names.empty() || map.labels.empty())
        throw InvalidInput({culprit, "is empty: every voxel is background", "one label or more",
                            "choose another file or segment again"});
    if (filing.reference) require_fit(map.grid, *filing.reference, culprit);
    const std::string digest = content_digest(map, filing);
    DcmFileFormat file;
    DcmDataset& data = *file.getDataset();
    put_header(data, filing, digest, UID_SegmentationStorage, "SEG", segmentation_series);
    if (filing.reference) {
        DcmItem& series = add_item(data, DCM_ReferencedSeriesSequence);
        put(series, DCM_SeriesInstanceUID, filing.reference->series_uid);
        add_instances(series, DCM_ReferencedInstanceSequence, *filing.reference);
    }
    put(data, DCM_ImageType, "DERIVED\\PRIMARY");
    put(data, DCM_ContentLabel, "SEGMENTATION");
    put(data, DCM_ContentDescription, "");
    put(data, DCM_ContentCreatorName, "");
    put(data, DCM_SegmentationType, "BINARY");
    put(data, DCM_LossyImageCompression, "00");
    put(data, DCM_SamplesPerPixel, Uint16{1});
    put(data, DCM_PhotometricInterpretation, "MONOCHROME2");
    put(data, DCM_Rows, static_cast<Uint16>(map.grid.size[1]));
    put(data, DCM_Columns, static_cast<Uint16>(map.grid.size[0]));
    put(data, DCM_BitsAllocated, Uint16{1});
    put(data, DCM_BitsStored, Uint16{1});
    put(data, DCM_HighBit, Uint16{0});
    put(data, DCM_PixelRepresentation, Uint16{0});
    put_segments(data, map, filing, culprit);
    put_dimensions(data, digest);
    put_shared_groups(data, map.grid);
    const std::vector<SegmentFrame> frames = frames_of(map);
    put(data, DCM_NumberOfFrames, std::to_string(frames.size()));
    for (const SegmentFrame& frame : frames) put_frame_groups(data, frame, map.grid, filing);
    const std::vector<Uint8> bits = packed_frames(map, frames);
    data.putAndInsertUint8Array(DCM_PixelData, bits.data(), bits.size());
    save_object(path, file);
}

}  // namespace palpate::archive
