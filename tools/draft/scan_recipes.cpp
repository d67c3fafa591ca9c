// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/draft/scan_recipes.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>

#include "formats/model/errors.hpp"

namespace palpate::draft {
namespace {

// Posterior and lateral walls, tubal tori and roof lie within that of the middle of an adult's nasopharynx.
constexpr double nasopharynx_radius_mm = 24;

ScanRecipes nasopharynx(const Eigen::Vector3d& seed) {
    return {
        .organ = "nasopharynx",
        .clicked = "airway",
        .where = "the air behind the nose, above the soft palate",
        .structures = {"skull: recipe=bone", "airway: recipe=airway",
                       fmt::format("nasopharynx: recipe=nasopharynx air=airway thickness_mm=8 smoothing_mm=2 "
                                   "center_mm={:.1f},{:.1f},{:.1f} radius_mm={:g}",
                                   seed[0], seed[1], seed[2], nasopharynx_radius_mm)},
        .tissue = "soft-palate",
        .rigid = {"skull"},
        .tool_radius = 1,  // its passages are narrow
        .held_by = {"skull", "background"}};
}

ScanRecipes one_structure(const std::string& organ, const std::string& recipe) {
    return {.organ = organ,
            .clicked = organ,
            .where = "the " + organ,
            .structures = {organ + ": " + recipe},
            .tissue = "",
            .rigid = {},
            .tool_radius = 0,
            .held_by = {}};
}

}  // namespace

ScanRecipes scan_recipes(const std::string& organ, bool ct, bool against_background,
                         const Eigen::Vector3d& seed) {
    std::string known = organ;
    std::ranges::transform(known, known.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (known == "nasopharynx") {
        if (!ct)
            throw UsageError({"--organ nasopharynx", "its wall is found between air and bone of a CT", "a CT",
                              "or a label map of it"});
        if (against_background)
            throw UsageError({"--organ nasopharynx", "is not grown against seeds around it", "",
                              "leave out --background-seed and points of 'background'"});
        return nasopharynx(seed);
    }
    if (against_background)
        return one_structure(organ,
                             "recipe=grow-from-seeds open_mm=2 keep_largest=yes fill_holes=yes smooth_mm=2");
    if (known == "liver" && ct) return one_structure(organ, "recipe=liver keep_largest=yes");
    // A brain's furrows are narrower than a tool.
    return one_structure(organ, known == "brain" ? "recipe=organ close_mm=6" : "recipe=organ");
}

}  // namespace palpate::draft
