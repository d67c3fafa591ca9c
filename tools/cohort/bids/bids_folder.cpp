// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/bids/bids_folder.hpp"

#include <algorithm>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/shallow_json.hpp"

namespace palpate::cohort {
namespace {

namespace fs = std::filesystem;

fs::path description_of(const fs::path& dataset) {
    return dataset / "dataset_description.json";
}

// No such file is an answer; that it cannot be looked at is none.
void require_readable(const fs::path& path, const std::error_code& error) {
    if (error && error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory)
        throw SystemFailure({path.string(), "could not be read: " + error.message(), "",
                             "check its permissions and its disk, then run again"});
}

// What a table could not hold is no name of BIDS either.
bool is_printable(const std::string& name) {
    return std::ranges::none_of(name, [](unsigned char c) { return c < ' ' || c == 127; });
}

bool is_folder(const fs::path& path) {
    std::error_code error;
    const bool folder = fs::is_directory(path, error);
    require_readable(path, error);
    return folder;
}

}  // namespace

bool is_there(const fs::path& path) {
    std::error_code error;
    const bool there = fs::exists(path, error);
    require_readable(path, error);
    return there;
}

std::vector<fs::path> entries_in(const fs::path& folder) {
    std::vector<fs::path> entries;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
        entries.push_back(at->path());
    require_readable(folder, error);
    std::ranges::sort(entries);
    return entries;
}

bool is_bids_dataset(const fs::path& folder) {
    return is_there(description_of(folder));
}

nlohmann::json dataset_description(const fs::path& dataset) {
    const fs::path path = description_of(dataset);
    if (!is_there(path))
        throw InvalidInput({dataset.string(), "has no dataset_description.json",
                            "the folder of a BIDS dataset", "choose the folder that has it"});
    nlohmann::json description = imaging::read_json_file(path);
    if (!description.is_object())
        throw InvalidInput({path.string(), "is no JSON object, or nested more than 32 deep",
                            "{\"Name\": ..., \"BIDSVersion\": ...}", "correct the file"});
    return description;
}

bool is_ours(const nlohmann::json& description) {
    const auto makers = description.find("GeneratedBy");
    return makers != description.end() && makers->is_array() && makers->size() == 1 &&
           makers->front().is_object() && makers->front().value("Name", nlohmann::json()) == "Palpate";
}

std::vector<std::string> folders_in(const fs::path& folder, const std::string& prefix) {
    std::vector<std::string> names;
    for (const fs::path& entry : entries_in(folder))
        if (const std::string name = entry.filename().string();
            name.starts_with(prefix) && !name.starts_with('.') && is_printable(name) && is_folder(entry))
            names.push_back(name);
    return names;
}

std::vector<BidsFile> images_in(const fs::path& dataset, const fs::path& below) {
    std::vector<BidsFile> files;
    for (const char* type : {"anat", "ct"})
        for (const fs::path& entry : entries_in(dataset / below / type)) {
            const std::string name = entry.filename().string();
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
