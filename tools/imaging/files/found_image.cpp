// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <itkObject.h>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/read_image.hpp"

namespace palpate::imaging {
namespace {

const char* type_name(const StoredVoxels& voxels) {
    constexpr std::array names{"uint8", "int8",   "uint16", "int16",   "uint32",
                               "int32", "uint64", "int64",  "float32", "float64"};
    static_assert(names.size() == std::variant_size_v<StoredVoxels>);
    return names[voxels.index()];
}

// Whole numbers, and nearly every voxel of a structure beside one of its own.
bool looks_like_labels(const StoredImage& image) {
    return std::visit(
        [&](const auto& voxels) {
            std::size_t inside = 0, alike = 0;
            for (std::size_t v = 0; v + 1 < voxels.size(); ++v) {
                const double value = label_value(image, static_cast<double>(voxels[v]));
                if (!(value >= 0 && value <= 65535) || value != std::floor(value)) return false;
                if (value == 0) continue;
                ++inside;
                alike += voxels[v + 1] == voxels[v];
            }
            return inside > 0 && static_cast<double>(alike) > 0.7 * static_cast<double>(inside);
        },
        image.voxels);
}

// Why a file's image is a label map; empty if it is none.
std::string why_labels(const StoredImage& image) {
    if (image.header.contains("Segment0_Name")) return "its header names segments";
    if (!image.labels.empty()) return "its header names labels";
    if (image.layers == 1 && looks_like_labels(image))
        return "its values are whole numbers in patches of one value";
    return "";
}

FoundImage found_in_dicom(const std::filesystem::path& path, bool segmentation, const NoteSink& note,
                          const ReadOptions& options) {
    if (segmentation)
        return {.image = read_label_map(path, note, options),
                .told_by = "it is a DICOM segmentation object",
                .stored_type = "binary",
                .modality = "SEG"};
    DicomImage read = read_dicom(path, note, options);
    check_values(read.volume, path);
    return {.image = std::move(read.volume),
            .told_by = "it is DICOM of grey values",
            .stored_type = read.stored_type,
            .modality = read.modality};
}

}  // namespace

FoundImage read_image(const std::filesystem::path& path, ImageKind kind, const NoteSink& note,
                      const ReadOptions& options) {
    itk::Object::GlobalWarningDisplayOff();
    require_image_source(path);
    try {
        if (std::error_code none; std::filesystem::is_directory(path, none) || is_dicom(path)) {
            const bool segmentation =
                kind == ImageKind::labels || (kind == ImageKind::found_out && is_dicom_segmentation(path));
            return found_in_dicom(path, segmentation, note, options);
        }
        StoredImage stored = read_image_file(path, note, options);
        const std::string type = type_name(stored.voxels);
        const std::string why = kind == ImageKind::found_out ? why_labels(stored) : "it was said to be";
        if (kind == ImageKind::volume || why.empty())
            return {.image = volume_from(std::move(stored), path),
                    .told_by = why.empty() ? "its values are no labels" : why,
                    .stored_type = type,
                    .modality = ""};
        return {.image = label_map_from(std::move(stored), path, note, options.overlaps),
                .told_by = why,
                .stored_type = type,
                .modality = ""};
    } catch (const std::bad_alloc&) {
        throw beyond_memory(path);
    }
}

}  // namespace palpate::imaging
