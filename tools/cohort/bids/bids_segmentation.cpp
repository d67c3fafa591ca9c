// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/bids/bids_segmentation.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/model/errors.hpp"

namespace palpate::cohort {
namespace {

namespace fs = std::filesystem;

// Entities that tell acquisitions apart; a derivative has its source's.
constexpr std::array acquisition_entities{"task", "acq", "ce", "rec", "dir", "run", "echo", "inv", "part"};

bool is_of(const BidsName& segmentation, const BidsName& image) {
    return std::ranges::all_of(acquisition_entities, [&](const char* entity) {
        const std::string value = segmentation[entity];
        return value.empty() || value == image[entity];
    });
}

// The most specific of the nearest.
std::vector<fs::path> label_tables_of(const fs::path& dataset, const BidsFile& segmentation) {
    fs::path folder = segmentation.path;
    do {
        folder = folder.parent_path();
        std::vector<fs::path> best;
        std::size_t most = 0;
        for (const fs::path& entry : entries_in(dataset / folder)) {
            const auto name = parse_bids_name(entry.filename().string(), false);
            if (!name || name->suffix != "dseg" || name->extension != ".tsv" ||
                !segmentation.name.has_all_of(*name))
                continue;
            if (name->entities.size() > most) best.clear();
            if (name->entities.size() >= most) best.push_back(entry);
            most = std::max(most, name->entities.size());
        }
        if (!best.empty()) return best;
    } while (!folder.empty());
    return {};
}

ChosenSegmentation with_label_table(const fs::path& dataset, const BidsFile& segmentation) {
    ChosenSegmentation chosen{dataset / segmentation.path, {}, ""};
    const std::vector<fs::path> tables = label_tables_of(dataset, segmentation);
    if (tables.size() == 1) chosen.label_table = tables[0];
    if (tables.size() > 1)
        chosen.problem = fmt::format(
            "has {} tables of label names that are as near as each other, {} and {}; keep one, or name one "
            "in "
            "the column label_names",
            tables.size(), tables[0].filename().string(), tables[1].filename().string());
    return chosen;
}

}  // namespace

std::vector<fs::path> segmentation_folders(const fs::path& dataset, const fs::path& derivatives) {
    if (!derivatives.empty()) {
        if (!fs::is_directory(derivatives))
            throw InvalidInput({derivatives.string(), "is no folder", "a dataset of derivatives", ""});
        return {derivatives};
    }
    std::vector<fs::path> folders{dataset};
    for (const std::string& name : folders_in(dataset / "derivatives", "")) {
        const fs::path folder = dataset / "derivatives" / name;
        if (!is_bids_dataset(folder) || !is_ours(dataset_description(folder))) folders.push_back(folder);
    }
    return folders;
}

ChosenSegmentation choose_segmentation(std::span<const fs::path> folders, const fs::path& below,
                                       const BidsName& image, const BidsName& wanted) {
    std::vector<std::pair<fs::path, BidsFile>> found;
    std::vector<std::string> names;
    for (const fs::path& folder : folders)
        for (const BidsFile& file : images_in(folder, below))
            if (file.name.suffix == "dseg" && in_own_space(file.name, image.suffix) &&
                is_of(file.name, image) && file.name.has_all_of(wanted)) {
                found.emplace_back(folder, file);
                names.push_back((folder.filename() / file.path.filename()).string());
            }
    ChosenSegmentation chosen;
    if (found.empty())
        chosen.problem = fmt::format(
            "has no segmentation {}_dseg.nii.gz that belongs to {}; add one to "
            "derivatives/, or name one in the column labels",
            patient_name(below), spelled(image));
    else if (found.size() > 1)
        chosen.problem = fmt::format(
            "has {} segmentations, {}; choose with --segmentation or --derivatives, "
            "or name one in the column labels",
            found.size(), fmt::join(names, ", "));
    else
        chosen = with_label_table(found[0].first, found[0].second);
    return chosen;
}

}  // namespace palpate::cohort
