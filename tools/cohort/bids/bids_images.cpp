// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/bids/bids_images.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <set>

#include "formats/model/errors.hpp"

namespace palpate::cohort {
namespace {

namespace fs = std::filesystem;
using Note = std::function<void(std::string_view)>;

constexpr std::array preferred_suffixes{"T1w", "T2w", "FLAIR", "PDw", "T2starw", "UNIT1", "ct"};

std::vector<BidsFile> candidates(const Scan& scan, const BidsName& wanted) {
    std::vector<BidsFile> found;
    for (const BidsFile& file : scan.images)
        if (file.name.suffix == wanted.suffix && file.name.has_all_of(wanted) &&
            (in_own_space(file.name, wanted.suffix) || !wanted["space"].empty()))
            found.push_back(file);
    return found;
}

std::string names_of(const std::vector<BidsFile>& files) {
    std::vector<std::string> names;
    for (const BidsFile& file : files) names.push_back(file.path.filename().string());
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string without_run(BidsName name) {
    std::erase_if(name.entities, [](const auto& entity) { return entity.first == "run"; });
    return spelled(name);
}

// "10" comes after "9" and "09".
std::pair<std::size_t, std::string> run_of(const BidsFile& file) {
    std::string run = file.name["run"];
    run.erase(0, run.find_first_not_of('0'));
    return {run.size(), run};
}

}  // namespace

std::vector<Scan> scans_of(const fs::path& dataset) {
    std::vector<Scan> scans;
    for (const std::string& subject : folders_in(dataset, "sub-")) {
        const auto sessions = folders_in(dataset / subject, "ses-");
        for (const std::string& session : sessions)
            scans.push_back({subject, fs::path(subject) / session, {}});
        if (sessions.empty()) scans.push_back({subject, subject, {}});
    }
    for (Scan& scan : scans) scan.images = images_in(dataset, scan.below);
    if (scans.empty())
        throw InvalidInput({dataset.string(), "has no subjects", "folders sub-01, sub-02, ...",
                            "choose the folder that has them"});
    return scans;
}

BidsName image_of_most(std::span<const Scan> scans, BidsName wanted, const Note& note) {
    if (!wanted.suffix.empty()) return wanted;
    std::vector<std::string> there;
    std::size_t most = 0;
    std::string best = preferred_suffixes.front();
    for (const char* suffix : preferred_suffixes) {
        wanted.suffix = suffix;
        std::set<std::string> subjects;
        for (const Scan& scan : scans)
            if (!candidates(scan, wanted).empty()) subjects.insert(scan.subject);
        if (!subjects.empty()) there.emplace_back(suffix);
        if (subjects.size() > most) best = suffix;
        most = std::max(most, subjects.size());
    }
    wanted.suffix = best;
    std::erase(there, best);
    if (!there.empty())
        note(fmt::format("the {} images are taken; there are {} too, which --image chooses", best,
                         fmt::join(there, ", ")));
    return wanted;
}

std::vector<Scan> with_images(std::span<const Scan> scans, const BidsName& wanted, const Note& note) {
    std::map<std::string, std::ptrdiff_t> scanned;  // sessions of each subject that have the image
    for (const Scan& scan : scans) scanned[scan.subject] += !candidates(scan, wanted).empty();
    std::vector<Scan> kept;
    std::vector<std::string> left_out;
    for (const Scan& scan : scans) {
        if (!candidates(scan, wanted).empty())
            kept.push_back(scan);
        else if (scanned[scan.subject] > 0)
            left_out.push_back(patient_name(scan.below));
        else if (kept.empty() || kept.back().subject != scan.subject)
            kept.push_back({scan.subject, scan.subject, scan.images});
        else
            kept.back().images.insert(kept.back().images.end(), scan.images.begin(), scan.images.end());
    }
    if (!left_out.empty())
        note(fmt::format("left out, for they have no {} image and another session has: {}", wanted.suffix,
                         fmt::join(left_out, ", ")));
    return kept;
}

ChosenImage choose_image(const Scan& scan, const BidsName& wanted) {
    const std::vector<BidsFile> found = candidates(scan, wanted);
    ChosenImage chosen;
    if (scan.images.empty()) {
        chosen.problem = "has no image in anat/ or ct/; add one, or delete this line";
    } else if (found.empty()) {
        chosen.problem = fmt::format(
            "has no {} image; there are {}: choose with --image, or name one in the column volume",
            spelled(wanted), names_of(scan.images));
    } else if (std::ranges::any_of(found, [&](const BidsFile& file) {
                   return without_run(file.name) != without_run(found[0].name);
               })) {
        chosen.problem =
            fmt::format("has {} {} images, {}; choose with --image, or name one in the column volume",
                        found.size(), spelled(wanted), names_of(found));
    } else {
        chosen.file = *std::ranges::min_element(found, {}, run_of);
        if (found.size() > 1) chosen.note = fmt::format("the first of {} runs", found.size());
    }
    return chosen;
}

}  // namespace palpate::cohort
