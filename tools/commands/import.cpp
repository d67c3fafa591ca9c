// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/files/label_names.hpp"

namespace {

using namespace palpate;

nlohmann::ordered_json describe(const ImageGrid& grid) {
    const auto numbers = [](const auto& v) { return std::vector<double>(v.data(), v.data() + v.size()); };
    return {{"size", grid.size},
            {"spacing_mm", numbers(grid.spacing)},
            {"origin_mm", numbers(grid.origin)},
            {"direction_columns", numbers(grid.direction)}};
}

nlohmann::ordered_json describe(const LabelMap& map) {
    nlohmann::ordered_json result = {{"grid", describe(map.grid)},
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

// Free text and UIDs may identify a patient: for eyes on a terminal, not for files and logs.
nlohmann::ordered_json describe(const std::vector<SeriesSummary>& list, bool free_text) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const SeriesSummary& series : list) {
        nlohmann::ordered_json row = {
            {"number", series.number},           {"modality", series.modality},
            {"slices", series.size[2]},          {"rows", series.size[1]},
            {"columns", series.size[0]},         {"spacing_i_mm", series.spacing[0]},
            {"spacing_j_mm", series.spacing[1]}, {"spacing_k_mm", series.spacing[2]},
            {"localizer", series.localizer}};
        if (free_text) {
            row["description"] = series.description;
            row["uid"] = series.uid;
        }
        rows.push_back(row);
    }
    return {{"series", rows}};
}

Overlaps overlaps_of(const std::string& text) {
    if (text == "refuse") return Overlaps::refuse;
    if (text == "later") return Overlaps::later_wins;
    if (text == "smaller") return Overlaps::smaller_wins;
    throw UsageError({"--overlaps", "'" + text + "'", "refuse, later or smaller", ""});
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "import",
         .summary = "Turns a volume or a label map of any readable format into NRRD in LPS mm",
         .examples = {"palpate import ct_series/ --series 3 -o volume.nrrd",
                      "palpate import --labels seg.nii.gz --label-names totalsegmentator:v2/total -o "
                      "labels.seg.nrrd"},
         .notes = "Reads DICOM (a folder of slices or a file of several frames), NRRD, MetaImage, NIfTI or "
                  "VTK image\n"
                  "data; label maps also from DICOM SEG. Only geometry, values and label names are kept: no "
                  "patient,\n"
                  "study or file fields. CT values are in HU.\n"
                  "Of several DICOM series one must be chosen, unless the others are localizers or have at "
                  "most a\n"
                  "fifth of its slices. A series' number is its DICOM number where all differ, else its "
                  "place in the\n"
                  "list. Descriptions and UIDs, which may identify a patient, are shown on a terminal only.\n"
                  "Label names: 5=liver,4=gallbladder (other values are dropped); "
                  "totalsegmentator:VERSION/TASK, as\n"
                  "v1/total, v2/total, v2/total_mr or v2/head_glands_cavities; or a table file: Slicer "
                  ".ctbl, ITK-SNAP,\n"
                  "FreeSurfer, BIDS .tsv, JSON, or lines 'value name'. Without it names come from the file "
                  "itself\n"
                  "(.seg.nrrd, DICOM SEG, TotalSegmentator's NIfTI), else they are label_<value>."});
    std::filesystem::path input, output;
    bool labels = false, list = false;
    std::string label_names, overlaps = "refuse";
    ReadOptions options;
    command
        .input("input", input, "DICOM folder or file, .nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz, .vti or .vtk")
        .required();
    command.output("-o,--output", output, "volume (.nrrd) or, with --labels, label map (.seg.nrrd)");
    command.flag("--list", list, "list the DICOM series of the input and make nothing");
    command.option("--series", options.series, "DICOM series to read: its number, UID or description");
    command.flag("--accept-gaps", options.accept_gaps,
                 "interpolate missing, uneven, doubled or tilted DICOM slices linearly onto an even grid");
    command.option("--nifti-frame", options.nifti_frame,
                   "qform or sform, for a NIfTI file in which both are set and disagree");
    command.flag("--labels", labels, "the input is a label map");
    command.option("--label-names", label_names,
                   "names of the labels: value=name,..., a known table or a file");
    const cli::Option overlaps_option =
        command.option("--overlaps", overlaps,
                       "where segments of a label map overlap: refuse, later (in the file) or smaller wins");
    return command.run(argc, argv, [&](cli::Session& session) -> nlohmann::ordered_json {
        const auto require = [](bool fits, const char* option, const char* input_kind, const char* advice) {
            if (!fits) throw UsageError({option, std::string("is for ") + input_kind, "", advice});
        };
        std::error_code none;
        const bool dicom_image = !labels && (std::filesystem::is_directory(input, none) || is_dicom(input));
        require(labels || label_names.empty(), "--label-names", "label maps", "add --labels");
        require(labels || !overlaps_option.given(), "--overlaps", "label maps", "add --labels");
        require(dicom_image || options.series.empty(), "--series", "DICOM images", "leave it out");
        require(dicom_image || !options.accept_gaps, "--accept-gaps", "DICOM images", "leave it out");
        require(options.nifti_frame.empty() || is_nifti(input), "--nifti-frame", "NIfTI files",
                "leave it out");
        options.show_descriptions = isatty(STDERR_FILENO) == 1;
        if (list != output.empty())
            throw UsageError({"--output", list ? "given with --list" : "not given", "", "give one of them"});
        options.overlaps = overlaps_of(overlaps);
        set_imaging_threads(session.threads);
        std::vector<std::string> notes;
        const NoteSink note = [&](std::string_view text) {
            spdlog::warn("{}", text);
            notes.emplace_back(text);
        };
        if (list) {
            return describe(list_series(input, note), !session.json && isatty(STDOUT_FILENO) == 1);
        }
        auto staged = session.stage(output);
        session.progress.step("reading", 0);
        nlohmann::ordered_json result;
        if (labels) {
            LabelMap map = read_label_map(input, note, options);
            name_labels(map, label_names, note);
            session.progress.step("writing", 0.5);
            write_label_map(staged.path(), map);
            result = describe(map);
        } else {
            const Volume volume = read_volume(input, note, options);
            const auto [low, high] = std::ranges::minmax(volume.values);
            session.progress.step("writing", 0.5);
            write_volume(staged.path(), volume);
            result = {{"grid", describe(volume.grid)}, {"lowest", low}, {"highest", high}};
        }
        result["notes"] = notes;
        staged.commit();
        return result;
    });
}
