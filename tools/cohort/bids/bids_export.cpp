// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/bids/bids_export.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/outputs/staged_file.hpp"
#include "tools/cohort/bids/bids_folder.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/files/label_names.hpp"

namespace palpate::cohort {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* readme = R"(# Haptic assets

Made by Palpate, a tool that turns a patient's CT or MRI into an organ that a hand can feel. Of each scan:

- `*_desc-palpate_dseg.nii.gz`: the structures of the asset, in the space of the image that they are from;
  the `.tsv` beside it names them.
- `*_desc-palpate_asset.vtkhdf`: the asset, which `palpate touch` and `palpate train` open, and ParaView as an
  unstructured grid. Lengths are in mm, positions LPS.
- `*_desc-palpate_report.html`: what it is and how good it is, with pictures.

BIDS does not know the last two; `.bidsignore` says so.
)";

bool lies_in(const fs::path& path, const fs::path& folder) {
    const fs::path relative = path.lexically_relative(folder);
    return !relative.empty() && *relative.begin() != "..";
}

fs::path place_of(const fs::path& path) {
    return fs::weakly_canonical(fs::absolute(path));
}

// An image of a BIDS dataset.
struct SourceImage {
    fs::path dataset;  // canonical
    BidsFile file;
};

// The dataset is the folder above the subject's.
SourceImage source_of(const PatientBuild& build) {
    const std::string& patient = build.patient.name;
    if (!build.case_file.volume)
        throw InvalidInput({build.patient.where, "'" + patient + "' was built without an image",
                            "an image of a BIDS dataset, which the derivatives are named after",
                            "name the image that it is of in the column volume and build again"});
    const fs::path image = fs::absolute(*build.case_file.volume).lexically_normal();
    const std::string subject = patient.substr(0, patient.find('_'));
    fs::path dataset;
    for (const fs::path& part : image) {
        if (part == subject && subject.starts_with("sub-") && is_bids_dataset(dataset)) {
            const auto name = parse_bids_name(image.filename().string());
            if (name) return {fs::canonical(dataset), {image.lexically_relative(dataset), *name}};
        }
        dataset /= part;
    }
    throw InvalidInput({build.patient.where,
                        "'" + patient + "' is not named after an image of a BIDS dataset",
                        "a patient sub-01, with sub-01/anat/sub-01_T1w.nii.gz or the like as volume",
                        "build the cohort from a BIDS dataset: palpate batch DATASET --case CASE -o OUTPUT"});
}

// How the derivative's files name those of their source.
class SourceLink {
  public:
    SourceLink(fs::path dataset, const fs::path& output) : dataset_(std::move(dataset)) {
        const nlohmann::json description = dataset_description(dataset_);
        if (const auto doi = description.find("DatasetDOI");
            doi != description.end() && doi->is_string() && !doi->get<std::string>().empty()) {
            doi_ = doi->get<std::string>();
            link_ = doi_.find(':') == std::string::npos ? "doi:" + doi_ : doi_;
        }
        const fs::path place = place_of(output);
        if (lies_in(place, dataset_)) link_ = dataset_.lexically_relative(place).generic_string();
    }

    bool given() const { return !link_.empty(); }

    // "bids:raw:sub-01/anat/sub-01_T1w.nii.gz"; nothing for a file that is not in the dataset.
    std::optional<std::string> uri_of(const fs::path& file) const {
        const fs::path full = file.is_absolute() ? file.lexically_normal() : dataset_ / file;
        if (!given() || !lies_in(full, dataset_)) return std::nullopt;
        return "bids:raw:" + full.lexically_relative(dataset_).generic_string();
    }

    // SourceDatasets take no relative address; DatasetLinks do.
    void describe(Json& description) const {
        if (!doi_.empty()) description["SourceDatasets"] = Json::array({{{"DOI", doi_}}});
        if (given()) description["DatasetLinks"] = {{"raw", link_}};
    }

  private:
    fs::path dataset_;
    std::string link_, doi_;
};

void write_structures(const fs::path& labels, const fs::path& stem, const SourceImage& source,
                      const PatientBuild& build, const SourceLink& link) {
    const LabelMap map = imaging::read_label_map(labels);
    imaging::write_nifti_labels(stem.string() + "dseg.nii.gz", map);
    cli::write_text_file(stem.string() + "dseg.tsv", imaging::bids_label_table(map.names), false);
    Json sidecar{{"Description", "Structures of the haptic asset, in the space of the image"}};
    const auto image = link.uri_of(source.file.path);
    if (image) sidecar["Sources"] = Json::array({*image});
    const auto segmentation =
        build.case_file.labels ? link.uri_of(fs::absolute(*build.case_file.labels)) : std::nullopt;
    if (segmentation) sidecar["Sources"].push_back(*segmentation);
    sidecar["SpatialReference"] = image.value_or("orig");
    cli::write_text_file(stem.string() + "dseg.json", sidecar.dump(2) + "\n", false);
}

// "sub-01/ses-02/anat/sub-01_ses-02_desc-palpate_", what names of the patient's files begin with.
fs::path stem_of(const SourceImage& source) {
    auto part = source.file.path.begin();
    fs::path place = *part;
    if (++part != source.file.path.end() && part->string().starts_with("ses-") &&
        *part != source.file.path.filename())
        place /= *part;
    BidsName name{source.file.name.entities, "", ""};
    std::erase_if(name.entities, [](const auto& entity) { return entity.first == "desc"; });
    name.entities.emplace_back("desc", "palpate");
    return place / "anat" / spelled(name);
}

void require_own_names(const std::vector<std::pair<const PatientBuild*, SourceImage>>& built) {
    std::map<fs::path, const PatientBuild*> patients;
    for (const auto& [build, source] : built) {
        const auto [other, is_first] = patients.try_emplace(stem_of(source), build);
        if (!is_first)
            throw InvalidInput({build->patient.where,
                                fmt::format("'{}' and '{}' would both be {}*", other->second->patient.name,
                                            build->patient.name, other->first.string()),
                                "one patient of each subject, session, acquisition and run",
                                "put one of them into a cohort of its own and export that elsewhere"});
    }
}

void write_patient(const PatientBuild& build, const SourceImage& source, const SourceLink& link,
                   const fs::path& folder) {
    const std::string stem = (folder / stem_of(source)).string();
    fs::create_directories(fs::path(stem).parent_path());
    const fs::path labels = build.paths.parts / "labels.seg.nrrd";
    if (needs_labels(build.case_file)) write_structures(labels, stem, source, build, link);
    fs::copy_file(build.paths.asset, stem + "asset.vtkhdf");
    fs::copy_file(build.paths.report, stem + "report.html");
}

// In the words of what failed, without the line break at their end.
std::string reason_of(const PatientResult& result) {
    if (result.outcome == Outcome::unfinished)
        return "is not built, or its inputs changed since; run 'palpate batch' again";
    return result.said.substr(0, result.said.find_last_not_of('\n') + 1);
}

void write_description(const fs::path& folder, const SourceLink& link) {
    Json description{{"Name", "Haptic assets by Palpate"},
                     {"BIDSVersion", "1.9.0"},
                     {"DatasetType", "derivative"},
                     {"GeneratedBy", Json::array({{{"Name", "Palpate"}, {"Version", cli::version()}}})}};
    link.describe(description);
    cli::write_text_file(folder / "dataset_description.json", description.dump(2) + "\n", false);
    cli::write_text_file(folder / "README.md", readme, false);
    cli::write_text_file(folder / ".bidsignore", "*_asset.vtkhdf\n*_report.html\n", false);
}

}  // namespace

BidsExport write_bids_dataset(const Cohort& cohort, const States& states, const fs::path& output,
                              const fs::path& folder, const std::function<void(double)>& before_each) {
    BidsExport made;
    std::vector<std::pair<const PatientBuild*, SourceImage>> built;
    for (std::size_t i = 0; i < states.size(); ++i) {
        const PatientResult result = result_of(cohort.builds[i], states[i]);
        if (result.outcome == Outcome::built)
            built.emplace_back(&cohort.builds[i], source_of(cohort.builds[i]));
        else
            made.left_out.emplace_back(result.patient, reason_of(result));
    }
    if (built.empty())
        throw InvalidInput({cohort.folder.root.string(),
                            "has no patient that is built as its table and inputs are now", "one at least",
                            "build it first: palpate batch"});
    const fs::path& dataset = built.front().second.dataset;
    for (const auto& [build, source] : built)
        if (source.dataset != dataset)
            throw InvalidInput({build->patient.where, "comes from " + source.dataset.string(),
                                dataset.string() + ", where the first patient comes from",
                                "build a cohort of each dataset"});
    require_outside(output, dataset);
    require_own_names(built);
    const SourceLink link(dataset, output);
    made.linked = link.given();
    for (const auto& [build, source] : built) {
        before_each(static_cast<double>(made.patients.size()) / static_cast<double>(built.size()));
        write_patient(*build, source, link, folder);
        made.patients.push_back(build->patient.name);
    }
    write_description(folder, link);
    return made;
}

void require_outside(const fs::path& output, const fs::path& source) {
    if (lies_in(place_of(source), place_of(output)))
        throw InvalidInput({output.string(), "has " + source.string() + " in it, of which it would be made",
                            "a folder of its own", "choose another name"});
}

void require_replaceable(const fs::path& output) {
    if (!fs::exists(fs::symlink_status(output)) || (fs::is_directory(output) && fs::is_empty(output))) return;
    if (!is_bids_dataset(output) || !is_ours(dataset_description(output)))
        throw InvalidInput({output.string(), "is there and is no dataset that Palpate made",
                            "a new folder, or one of an earlier export", "choose another name"});
}

}  // namespace palpate::cohort
