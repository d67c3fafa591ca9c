// SPDX-License-Identifier: GPL-3.0-or-later
// DCMTK's headers first: its configuration macros must not be seen twice.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmfg/fgpixmsr.h>
#include <dcmtk/dcmfg/fgplanor.h>
#include <dcmtk/dcmfg/fgplanpo.h>
#include <dcmtk/dcmfg/fgseg.h>
#include <dcmtk/dcmiod/cielabutil.h>
#include <dcmtk/dcmseg/segdoc.h>
#include <dcmtk/dcmseg/segment.h>
#include <fmt/format.h>
#include <memory>

#include "formats/model/errors.hpp"
#include "tools/imaging/dicom/dicom_codes.hpp"
#include "tools/imaging/dicom/dicom_structure.hpp"
#include "tools/imaging/files/read_image.hpp"
#include "tools/imaging/files/segment_painter.hpp"

namespace palpate::imaging {
namespace {

struct Frame {
    std::size_t segment = 0;  // index
    Eigen::Vector3d origin;
};

// One segmentation object, with what it says of its grid.
class Source {
  public:
    explicit Source(const std::filesystem::path& path) : path_(path) {
        require_sound_dicom(path);
        OFLog::configure(OFLogger::OFF_LOG_LEVEL);
        if (const OFCondition loaded = file_.loadFile(path.c_str()); loaded.bad())
            throw refuse(loaded.text());
        OFString modality;
        file_.getDataset()->findAndGetOFString(DCM_Modality, modality);
        if (modality != "SEG")
            throw InvalidInput(  // NOLINTNEXTLINE(readability-redundant-string-cstr): as below
                {path.string(), "is DICOM of modality '" + modality_code(modality.c_str()) + "'",
                 "a segmentation object (SEG) as a label map", "leave --labels out to read an image"});
        if (file_.getDataset()->convertToUTF8().bad()) {
            // Names stay in the character set of the file.
        }
        file_.getDataset()->findAndGetUint16(DCM_Rows, rows_);
        file_.getDataset()->findAndGetUint16(DCM_Columns, columns_);
        DcmSegmentation* loaded = nullptr;
        const OFCondition read = DcmSegmentation::loadDataset(*file_.getDataset(), loaded);
        object_.reset(loaded);
        if (read.bad() || !object_) throw refuse(read.text());
        if (object_->getSegmentationType() != DcmSegTypes::ST_BINARY)
            throw InvalidInput({path.string(), "is a fractional segmentation", "a binary one",
                                "export it with a threshold"});
        read_segments();
        read_frames();
        find_bits();
    }

    const std::vector<Label>& segments() const { return segments_; }
    const std::vector<Frame>& frames() const { return frames_; }
    ImageGrid grid(const NoteSink& note) const;

    // The pixels of a frame, 0 or 1, rows * columns of them. Frames follow each other bit by bit
    // (PS3.5 8.1.1); DCMTK 3.6.7 misplaces those that do not begin with a byte.
    std::vector<std::uint8_t> pixels(std::size_t frame) const {
        std::vector<std::uint8_t> unpacked(std::size_t{rows_} * columns_);
        std::size_t bit = frame * unpacked.size();
        for (std::uint8_t& pixel : unpacked) {
            pixel = static_cast<std::uint8_t>(bits_[bit / 8] >> bit % 8 & 1U);
            ++bit;
        }
        return unpacked;
    }

  private:
    InvalidInput refuse(const std::string& reason) const {
        return InvalidInput({path_.string(), "cannot be read: " + reason, "a DICOM segmentation object",
                             "check that the file is whole"});
    }

    template <typename Group>
    Group& group(std::size_t frame, DcmFGTypes::E_FGType type) const {
        FGBase* found = object_->getFunctionalGroups().get(static_cast<Uint32>(frame), type);
        auto* typed = dynamic_cast<Group*>(found);
        if (typed == nullptr) throw refuse(fmt::format("frame {} lacks a functional group", frame + 1));
        return *typed;
    }

    void read_segments();
    void read_frames();
    void find_bits();

    std::filesystem::path path_;
    DcmFileFormat file_;
    std::unique_ptr<DcmSegmentation> object_;
    Uint16 rows_ = 0, columns_ = 0;
    std::vector<Label> segments_;
    std::vector<Frame> frames_;
    const Uint8* bits_ = nullptr;
};

void Source::read_segments() {
    for (std::size_t number = 1; number <= object_->getNumberOfSegments(); ++number) {
        DcmSegment* segment = object_->getSegment(number);
        if (segment == nullptr) throw refuse(fmt::format("segment {} is missing", number));
        Label label;
        label.value = static_cast<std::int32_t>(number);
        OFString name;
        segment->getSegmentLabel(name);
        // NOLINTNEXTLINE(readability-redundant-string-cstr): another DCMTK's OFString is no std::string
        label.name = name.empty() ? fmt::format("label_{}", number) : as_utf8(name.c_str());
        label.colour = default_label_colour(label.value);
        Uint16 l = 0, a = 0, b = 0;
        if (segment->getRecommendedDisplayCIELabValue(l, a, b).good() && (l || a || b)) {
            std::array<double, 3> rgb{};
            IODCIELabUtil::dicomLab2RGB(rgb[0], rgb[1], rgb[2], l, a, b);
            for (std::size_t i = 0; i < 3; ++i)
                label.colour[i] = static_cast<float>(std::clamp(rgb[i], 0.0, 1.0));
        }
        segments_.push_back(std::move(label));
    }
}

void Source::read_frames() {
    for (std::size_t i = 0; i < object_->getNumberOfFrames(); ++i) {
        Frame frame;
        Uint16 number = 0;
        group<FGSegmentation>(i, DcmFGTypes::EFG_SEGMENTATION).getReferencedSegmentNumber(number);
        if (number < 1 || number > segments_.size())
            throw refuse(fmt::format("frame {} belongs to segment {}, which is missing", i + 1, number));
        frame.segment = number - 1U;
        auto& position = group<FGPlanePosPatient>(i, DcmFGTypes::EFG_PLANEPOSPATIENT);
        if (position.getImagePositionPatient(frame.origin[0], frame.origin[1], frame.origin[2]).bad())
            throw refuse(fmt::format("frame {} has no position", i + 1));
        frames_.push_back(frame);
    }
    if (frames_.empty()) throw refuse("it holds no frame");
}

void Source::find_bits() {
    unsigned long bytes = 0;
    if (file_.getDataset()->findAndGetUint8Array(DCM_PixelData, bits_, &bytes).bad()) {
        const Uint16* words = nullptr;
        file_.getDataset()->findAndGetUint16Array(DCM_PixelData, words, &bytes);
        bits_ = reinterpret_cast<const Uint8*>(words);
        bytes *= 2;
    }
    if (bits_ == nullptr || bytes < (frames_.size() * rows_ * columns_ + 7) / 8)
        throw refuse("it holds fewer pixels than its header claims");
}

// The smallest grid that holds all frames; slices that no segment reaches may be left out of the file.
ImageGrid Source::grid(const NoteSink& note) const {
    ImageGrid grid;
    std::array<Float64, 6> o{};
    group<FGPlaneOrientationPatient>(0, DcmFGTypes::EFG_PLANEORIENTPATIENT)
        .getImageOrientationPatient(o[0], o[1], o[2], o[3], o[4], o[5]);
    grid.direction.leftCols<2>() = Eigen::Map<const Eigen::Matrix<double, 3, 2>>(o.data());
    grid.direction.col(2) = grid.direction.col(0).cross(grid.direction.col(1));
    auto& measures = group<FGPixelMeasures>(0, DcmFGTypes::EFG_PIXELMEASURES);
    measures.getPixelSpacing(grid.spacing[1], 0);
    measures.getPixelSpacing(grid.spacing[0], 1);

    const Eigen::Vector3d normal = grid.direction.col(2);
    const auto along = [&](const Frame& frame) { return normal.dot(frame.origin); };
    std::vector<double> positions;
    for (const Frame& frame : frames_) positions.push_back(along(frame));
    std::ranges::sort(positions);
    double gap = 0;
    for (std::size_t i = 1; i < positions.size(); ++i)
        if (const double step = positions[i] - positions[i - 1]; step > 1e-3 && (gap == 0 || step < gap))
            gap = step;
    const double length = positions.back() - positions.front();
    if (gap == 0 && measures.getSpacingBetweenSlices(gap, 0).bad()) measures.getSliceThickness(gap, 0);
    const double steps = gap > 0 ? std::round(length / gap) : 0;
    constexpr double sparsest = 1000;  // slices for each frame
    if (steps > sparsest * static_cast<double>(frames_.size()))
        throw InvalidInput({path_.string(),
                            fmt::format("frames lie between {:.3g} and {:.3g} mm apart", gap, length),
                            "frames on one grid", "resample the segmentation first"});
    grid.spacing[2] = steps > 0 ? length / steps : gap;
    // A volume has two slices at least; the second one may be empty.
    grid.size = {columns_, rows_, static_cast<std::int32_t>(std::clamp(steps, 1.0, 65535.0)) + 1};
    grid.origin = std::ranges::min_element(frames_, {}, along)->origin;
    check_geometry(grid, path_, note);
    check_claim(grid.voxel_count(), 8 * std::filesystem::file_size(path_), Packing::deflated, path_);  // bits
    return grid;
}

}  // namespace

bool is_dicom_segmentation(const std::filesystem::path& path) {
    if (!is_dicom(path)) return false;
    require_sound_dicom(path);
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    DcmFileFormat file;
    OFString modality;
    return file.loadFileUntilTag(path.c_str(), EXS_Unknown, EGL_noChange, DCM_MaxReadLength, ERM_autoDetect,
                                 DCM_PatientName)
               .good() &&
           file.getDataset()->findAndGetOFString(DCM_Modality, modality).good() && modality == "SEG";
}

LabelMap read_dicom_segmentation(const std::filesystem::path& path, const NoteSink& note, Overlaps overlaps) {
    const Source source(path);
    const ImageGrid grid = source.grid(note);
    const std::size_t plane = static_cast<std::size_t>(grid.size[0]) * static_cast<std::size_t>(grid.size[1]);
    std::vector<std::size_t> offsets, voxels(source.segments().size(), 0);
    for (std::size_t i = 0; i < source.frames().size(); ++i) {
        const Frame& frame = source.frames()[i];
        const Eigen::Vector3d index = grid.index_of(frame.origin);
        const auto k = static_cast<std::int32_t>(std::lround(index[2]));
        if ((index - Eigen::Vector3d(0, 0, k)).cwiseAbs().maxCoeff() > 0.02 || !grid.contains(0, 0, k))
            throw InvalidInput(
                {path.string(),
                 fmt::format("frame {} lies at slice {:.3f}, shifted by {:.3f} and {:.3f} voxels", i + 1,
                             index[2], index[0], index[1]),
                 "frames on one grid", "resample the segmentation first"});
        offsets.push_back(static_cast<std::size_t>(k) * plane);
        if (overlaps == Overlaps::smaller_wins)
            voxels[frame.segment] += static_cast<std::size_t>(std::ranges::count(source.pixels(i), 1));
    }
    SegmentPainter painter(grid, source.segments(), voxels, overlaps);
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        const std::vector<std::uint8_t> pixels = source.pixels(i);
        for (std::size_t n = 0; n < plane; ++n)
            if (pixels[n] != 0) painter.paint(offsets[i] + n, source.frames()[i].segment);
    }
    return painter.finish(path, note);
}

}  // namespace palpate::imaging
