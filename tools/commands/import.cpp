// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "tools/cli/command.hpp"
#include "tools/stages/image.hpp"

namespace {

using namespace palpate;
using namespace palpate::imaging;

const cli::CommandText text{
    .name = "import",
    .summary = "Turns a volume or a label map of any readable format into NRRD in LPS mm",
    .examples = {"palpate import ct_series/ --series 3 -o volume.nrrd",
                 "palpate import --labels seg.nii.gz --label-names totalsegmentator:v2/total -o "
                 "labels.seg.nrrd"},
    .notes =
        "Reads DICOM (a folder of slices or a file of several frames), NRRD, MetaImage, NIfTI or "
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
        "(.seg.nrrd, DICOM SEG, TotalSegmentator's NIfTI), else they are label_<value>."};

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

nlohmann::ordered_json run_import(const stages::ImportRequest& request, cli::Session& session) {
    check_request(request);
    ReadOptions options = read_options_of(request);
    options.show_descriptions = isatty(STDERR_FILENO) == 1;
    set_imaging_threads(session.threads);
    std::vector<std::string> notes;
    const NoteSink note = [&](std::string_view said) {
        spdlog::warn("{}", said);
        notes.emplace_back(said);
    };
    if (request.list)
        return describe(list_series(request.input, note), !session.json && isatty(STDOUT_FILENO) == 1);
    require_ending(request.output, request.labels ? ".seg.nrrd" : ".nrrd");
    cli::StagedFile staged = session.stage(request.output);
    nlohmann::ordered_json result = import_image(
        request, options, staged.path(),
        [&](std::string_view what, double done) { session.progress.step(what, done); }, note);
    result["notes"] = notes;
    staged.commit();
    return result;
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(text);
    stages::ImportRequest request;
    declare(command, request);
    return command.run(argc, argv, [&](cli::Session& session) { return run_import(request, session); });
}
