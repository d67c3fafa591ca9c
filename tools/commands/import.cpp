// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <filesystem>
#include <spdlog/spdlog.h>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/imaging/image_files.hpp"
#include "tools/imaging/label_names.hpp"
#include "tools/imaging/label_statistics.hpp"

namespace {

using namespace palpate;

nlohmann::json describe(const ImageGrid& grid) {
    const auto numbers = [](const auto& v) { return std::vector<double>(v.data(), v.data() + v.size()); };
    return {{"size", grid.size},
            {"spacing_mm", numbers(grid.spacing)},
            {"origin_mm", numbers(grid.origin)},
            {"direction_columns", numbers(grid.direction)}};
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "import",
         .summary = "Turns a volume or a label map of any readable format into NRRD in LPS mm",
         .examples = {"palpate import ct_series/ -o volume.nrrd",
                      "palpate import --labels seg.nii.gz --label-names 5=liver,4=gallbladder -o "
                      "labels.seg.nrrd"},
         .notes =
             "Reads a DICOM folder, NRRD, MetaImage or NIfTI. Only geometry, values and label names are\n"
             "kept: no patient, study or file fields. CT values stay in HU."});
    std::filesystem::path input, output;
    bool labels = false;
    std::string label_names;
    command.input("input", input, "DICOM folder, .nrrd, .nhdr, .mha, .mhd, .nii or .nii.gz")->required();
    command.output("-o,--output", output, "volume (.nrrd) or, with --labels, label map (.seg.nrrd)")
        ->required();
    command.flag("--labels", labels, "the input is a label map");
    command.option("--label-names", label_names,
                   "names by value, e.g. 5=liver,4=gallbladder; values not named are dropped");
    return command.run(argc, argv, [&](cli::Session& session) -> nlohmann::json {
        if (!labels && !label_names.empty())
            throw UsageError({"--label-names", "given without --labels", "", "add --labels"});
        set_imaging_threads(session.threads);
        auto staged = session.stage(output);
        std::vector<std::string> notes;
        const NoteSink note = [&](std::string_view text) {
            spdlog::warn("{}", text);
            notes.emplace_back(text);
        };
        session.progress.step("reading", 0);
        nlohmann::json result;
        if (labels) {
            LabelMap map = read_label_map(input, note);
            if (!label_names.empty()) rename_labels(map, parse_label_names(label_names));
            session.progress.step("writing", 0.5);
            write_label_map(staged.path(), map);
            result = {{"grid", describe(map.grid)}, {"labels", nlohmann::json::array()}};
            for (const LabelStatistics& label : label_statistics(map))
                result["labels"].push_back({{"name", label.label.name},
                                            {"value", label.label.value},
                                            {"voxels", label.voxels},
                                            {"volume_ml", label.volume_ml}});
        } else {
            const Volume volume = read_volume(input, note);
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
