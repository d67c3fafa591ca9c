// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/bids/bids_folder.hpp"

#include <algorithm>
#include <fstream>

#include "formats/model/errors.hpp"
#include "formats/model/small_file.hpp"
#include "tools/imaging/files/shallow_json.hpp"

namespace palpate::cohort {
namespace {

namespace fs = std::filesystem;

fs::path description_of(const fs::path& dataset) {
    return dataset / "dataset_description.json";
}

// What a table could not hold is no name of BIDS either.
bool is_printable(const std::string& name) {
    return std::ranges::none_of(name, [](unsigned char c) { return c < ' ' || c == 127; });
}

}  // namespace

bool is_bids_dataset(const fs::path& folder) {
    std::error_code none;
    return fs::exists(description_of(folder), none);
}

nlohmann::json dataset_description(const fs::path& dataset) {
    const fs::path path = description_of(dataset);
    constexpr std::uintmax_t most_bytes = 16 << 20;
    require_small_file(path, most_bytes);
    std::ifstream stream(path);
    if (!stream)
        throw InvalidInput({dataset.string(), "has no dataset_description.json",
                            "the folder of a BIDS dataset", "choose the folder that has it"});
    nlohmann::json description = imaging::shallow_json(stream);
    if (!description.is_object())
        throw InvalidInput({path.string(), "is no JSON object", "{\"Name\": ..., \"BIDSVersion\": ...}",
                            "correct the file"});
    return description;
}

bool is_ours(const nlohmann::json& description) {
    const auto makers = description.find("GeneratedBy");
    return makers != description.end() && makers->is_array() &&
           std::ranges::any_of(*makers, [](const nlohmann::json& maker) {
               return maker.is_object() && maker.contains("Name") && maker["Name"] == "Palpate";
           });
}

std::vector<std::string> folders_in(const fs::path& folder, const std::string& prefix) {
    std::vector<std::string> names;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none))
        if (const std::string name = entry.path().filename().string();
            name.starts_with(prefix) && !name.starts_with('.') && is_printable(name) &&
            entry.is_directory(none))
            names.push_back(name);
    std::ranges::sort(names);
    return names;
}

std::vector<BidsFile> images_in(const fs::path& dataset, const fs::path& below) {
    std::vector<BidsFile> files;
    std::error_code none;
    for (const char* type : {"anat", "ct"})
        for (const auto& entry : fs::directory_iterator(dataset / below / type, none)) {
            const std::string name = entry.path().filename().string();
            auto parsed = parse_bids_name(name);
            if (parsed && is_printable(name) && name.starts_with(patient_name(below) + "_") &&
                (parsed->extension == ".nii" || parsed->extension == ".nii.gz"))
                files.push_back({below / type / name, std::move(*parsed)});
        }
    std::ranges::sort(files, {}, &BidsFile::path);
    return files;
}

std::string patient_name(const fs::path& below) {
    std::string patient;
    for (const fs::path& part : below) patient += (patient.empty() ? "" : "_") + part.string();
    return patient;
}

bool in_own_space(const BidsName& name, const std::string& own) {
    const std::string space = name["space"];
    return space.empty() || space == "orig" || space == own;
}

}  // namespace palpate::cohort
