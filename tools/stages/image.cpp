// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/image.hpp"

#include <algorithm>

#include "formats/model/errors.hpp"
#include "tools/imaging/faces/face.hpp"
#include "tools/imaging/files/label_names.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"

namespace palpate::stages {
namespace {

using namespace imaging;

nlohmann::ordered_json describe(const LabelMap& map) {
    nlohmann::ordered_json result = {{"grid", to_json(map.grid)},
                                     {"labels", nlohmann::ordered_json::array()}};
    std::vector<std::size_t> voxels(65536, 0);
    for (const std::uint16_t value : map.labels) ++voxels[value];
    for (const Label& label : map.names) {
        const std::size_t count = voxels[label.value];
        result["labels"].push_back(
            {{"name", label.name},
             {"value", label.value},
             {"voxels", count},
             {"volume_ml", static_cast<double>(count) * map.grid.voxel_volume() / 1000}});
    }
    return result;
}

Volume defaced(Volume volume, const std::string& culprit, const NoteSink& note) {
    if (!is_ct(volume))
        throw InvalidInput({culprit, "its values are no HU, by which a face is told from bone and air",
                            "a CT",
                            "give scale and offset where it is a CT in other units; otherwise leave the "
                            "image out of what is "
                            "given away, in a case file by keep_scan = false"});
    if (shows_face(volume)) return without_face(volume);
    if (note) note("no face was found in the volume, and nothing taken away");
    return volume;
}

Overlaps overlaps_of(const std::string& text) {
    if (text == "refuse") return Overlaps::refuse;
    if (text == "later") return Overlaps::later_wins;
    if (text == "smaller") return Overlaps::smaller_wins;
    throw UsageError({"--overlaps", "'" + text + "'", "refuse, later or smaller", ""});
}

std::vector<double> numbers(const auto& v) {
    return std::vector<double>(v.data(), v.data() + v.size());
}

}  // namespace

nlohmann::ordered_json to_json(const ImageGrid& grid) {
    return {{"size", grid.size},
            {"spacing_mm", numbers(grid.spacing)},
            {"origin_mm", numbers(grid.origin)},
            {"direction_columns", numbers(grid.direction)}};
}

nlohmann::ordered_json scan_json(const std::optional<Scan>& scan) {
    if (!scan) return nullptr;
    return {{"size", scan->grid.size},
            {"spacing_mm", numbers(scan->grid.spacing)},
            {"values", scan->hounsfield ? "HU" : "grey values"}};
}

nlohmann::ordered_json to_json(const LabelStatistics& label) {
    return {{"name", label.label.name},
            {"value", label.label.value},
            {"voxels", label.voxels},
            {"volume_ml", label.volume_ml},
            {"components", label.components},
            {"box_min_mm", numbers(label.box.min())},
            {"box_max_mm", numbers(label.box.max())},
            {"centroid_mm", numbers(label.centroid)},
            {"at_image_edge", label.at_image_edge}};
}

void check_request(const ImportRequest& request) {
    const auto require = [](bool fits, const char* option, const char* input_kind, const char* advice) {
        if (!fits) throw UsageError({option, std::string("is for ") + input_kind, "", advice});
    };
    std::error_code none;
    const bool labels = request.labels,
               dicom_image =
                   !labels && (std::filesystem::is_directory(request.input, none) || is_dicom(request.input));
    require(labels || request.label_names.empty(), "--label-names", "label maps", "add --labels");
    require(labels || request.overlaps == "refuse", "--overlaps", "label maps", "add --labels");
    require(!labels || !request.deface, "--deface", "images", "leave it out");
    require(!labels || request.scale == 1, "--scale", "images", "leave it out");
    require(!labels || request.offset == 0, "--offset", "images", "leave it out");
    require(dicom_image || request.series.empty(), "--series", "DICOM images", "leave it out");
    require(dicom_image || !request.accept_gaps, "--accept-gaps", "DICOM images", "leave it out");
    require(request.nifti_frame.empty() || is_nifti(request.input), "--nifti-frame", "NIfTI files",
            "leave it out");
    if (request.list != request.output.empty())
        throw UsageError(
            {"--output", request.list ? "given with --list" : "not given", "", "give one of them"});
}

ReadOptions read_options_of(const ImportRequest& request) {
    return {.series = request.series,
            .accept_gaps = request.accept_gaps,
            .nifti_frame = request.nifti_frame,
            .overlaps = overlaps_of(request.overlaps)};
}

nlohmann::ordered_json import_image(const ImportRequest& request, const ReadOptions& options,
                                    const std::filesystem::path& file, const ProgressCallback& progress,
                                    const NoteSink& note) {
    progress("reading", 0);
    if (request.labels) {
        LabelMap map = read_label_map(request.input, note, options);
        name_labels(map, request.label_names, note);
        require_few_labels(map, request.input.string());
        progress("writing", 0.5);
        write_label_map(file, map);
        return describe(map);
    }
    Volume volume = read_volume(request.input, note, options);
    rescale(volume, {request.scale, request.offset});
    if (request.deface) {
        progress("taking the face away", 0.3);
        volume = defaced(std::move(volume), request.input.string(), note);
    }
    const auto [low, high] = std::ranges::minmax(volume.values);
    progress("writing", 0.5);
    write_volume(file, volume);
    return {{"grid", to_json(volume.grid)}, {"lowest", low}, {"highest", high}};
}

}  // namespace palpate::stages
