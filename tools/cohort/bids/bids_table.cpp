// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/bids/bids_table.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "formats/model/errors.hpp"
#include "tools/case_builder/case_file.hpp"
#include "tools/cohort/bids/bids_images.hpp"
#include "tools/cohort/bids/bids_segmentation.hpp"

namespace palpate::cohort {
namespace {

namespace fs = std::filesystem;
using Note = std::function<void(std::string_view)>;

struct Row {
    std::string patient;
    fs::path volume, labels, label_table;  // absolute
    std::string problem, note;
};

BidsName wanted_name(const std::string& text, const char* option) {
    const auto name = parse_bids_name(text, false);
    if (!name || !name->extension.empty())
        throw UsageError({option, "'" + text + "'", "entities and suffix, as in acq-mprage_T1w", ""});
    return *name;
}

void require_there(const fs::path& file, Row& row) {
    if (file.empty() || !row.problem.empty() || is_there(file)) return;
    row.problem = fmt::format("{} is a link to a file that is not there; fetch it, as by 'datalad get'",
                              file.filename().string());
}

void add_segmentation(const ChosenSegmentation& chosen, Row& row) {
    if (row.problem.empty()) row.problem = chosen.problem;
    row.labels = chosen.labels;
    row.label_table = chosen.label_table;
    require_there(row.labels, row);
    require_there(row.label_table, row);
}

std::string table_text(const std::vector<Row>& rows, const fs::path& case_file, const fs::path& folder,
                       bool with_labels) {
    const auto cell = [&](const fs::path& path) {
        const std::string text =
            folder.empty() || path.empty() ? path.string() : path.lexically_relative(folder).string();
        if (text.find_first_of("\t\r\n") != std::string::npos)
            throw InvalidInput({path.string(), "has a tab or a line break in its path", "",
                                "rename the folder: a table cannot hold it"});
        return text;
    };
    std::string text =
        fmt::format("patient\tcase\tvolume{}\tproblem\t#note\n", with_labels ? "\tlabels\tlabel_names" : "");
    for (const Row& row : rows) {
        text += fmt::format("{}\t{}\t{}", row.patient, cell(case_file), cell(row.volume));
        if (with_labels) text += fmt::format("\t{}\t{}", cell(row.labels), cell(row.label_table));
        text += fmt::format("\t{}\t{}\n", row.problem, row.note);
    }
    return text;
}

}  // namespace

std::string bids_patient_table(const fs::path& dataset, const fs::path& case_file, const fs::path& folder,
                               const BidsChoice& choice, const Note& note) {
    dataset_description(dataset);
    const case_builder::CaseFile read = case_builder::read_case_file(case_file);
    const bool with_labels =
        read.labels || std::ranges::any_of(read.structures, case_builder::imports_labels);
    const fs::path root = fs::canonical(dataset);
    const fs::path derivatives =
        choice.derivatives.empty() ? fs::path() : fs::weakly_canonical(choice.derivatives);
    const auto folders = with_labels ? segmentation_folders(root, derivatives) : std::vector<fs::path>();
    const BidsName wanted_labels = wanted_name(choice.segmentation, "--segmentation");
    if (!wanted_labels.suffix.empty() && wanted_labels.suffix != "dseg")
        throw UsageError(
            {"--segmentation", "'" + choice.segmentation + "'", "entities, as in seg-organs", ""});
    const std::vector<Scan> scans = scans_of(root);
    const BidsName wanted = image_of_most(scans, wanted_name(choice.image, "--image"), note);
    std::vector<Row> rows;
    for (const Scan& scan : with_images(scans, wanted, note)) {
        const ChosenImage image = choose_image(scan, wanted);
        Row& row = rows.emplace_back(Row{patient_name(scan.below), {}, {}, {}, image.problem, image.note});
        if (!image.file) continue;
        row.volume = root / image.file->path;
        require_there(row.volume, row);
        if (with_labels)
            add_segmentation(choose_segmentation(folders, scan.below, image.file->name, wanted_labels), row);
    }
    if (std::ranges::all_of(rows, [](const Row& row) { return row.volume.empty(); }))
        throw InvalidInput({dataset.string(), fmt::format("{} {}", rows[0].patient, rows[0].problem),
                            "an image of some subject", ""});
    const auto runs = std::ranges::count_if(rows, [](const Row& row) { return !row.note.empty(); });
    if (runs > 0) note(fmt::format("of several runs the first is taken, of {} patients", runs));
    return table_text(rows, fs::weakly_canonical(case_file), folder, with_labels);
}

}  // namespace palpate::cohort
