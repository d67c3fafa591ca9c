// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/draft/anatomy.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "formats/model/errors.hpp"

namespace palpate::draft {
namespace {

struct Word {
    const char* part_of_name;
    Part part;
    const char* tissue;
};

// The first that occurs in a name decides, so "liver_tumour" is a lesion, "kidney_cyst" one too.
constexpr std::array words{
    Word{"tumo", Part::lesion, "liver-tumour"},
    Word{"lesion", Part::lesion, "liver-tumour"},
    Word{"metasta", Part::lesion, "liver-tumour"},
    Word{"carcinoma", Part::lesion, "liver-tumour"},
    Word{"vessel", Part::vessel, ""},
    Word{"vein", Part::vessel, ""},
    Word{"vena", Part::vessel, ""},
    Word{"arter", Part::vessel, ""},
    Word{"aorta", Part::vessel, ""},
    Word{"vertebra", Part::bone, ""},
    Word{"rib_", Part::bone, ""},
    Word{"ribs", Part::bone, ""},
    Word{"costal", Part::bone, ""},
    Word{"skull", Part::bone, ""},
    Word{"crani", Part::bone, ""},
    Word{"bone", Part::bone, ""},
    Word{"stern", Part::bone, ""},
    Word{"sacrum", Part::bone, ""},
    Word{"hip_", Part::bone, ""},
    Word{"femur", Part::bone, ""},
    Word{"humer", Part::bone, ""},
    Word{"scapula", Part::bone, ""},
    Word{"clavic", Part::bone, ""},
    Word{"mandib", Part::bone, ""},
    Word{"tooth", Part::bone, ""},
    Word{"teeth", Part::bone, ""},
    Word{"spine", Part::bone, ""},
    Word{"airway", Part::aside, ""},
    Word{"lung", Part::aside, ""},
    Word{"muscle", Part::aside, ""},
    Word{"gluteus", Part::aside, ""},
    Word{"iliopsoas", Part::aside, ""},
    Word{"autochthon", Part::aside, ""},
    Word{"fat", Part::aside, ""},
    Word{"body", Part::aside, ""},
    Word{"skin", Part::aside, ""},
    Word{"torso", Part::aside, ""},
    Word{"liver", Part::organ, "liver"},
    Word{"kidney", Part::organ, "kidney"},
    Word{"spleen", Part::organ, "spleen"},
    Word{"pancreas", Part::organ, "pancreas"},
    Word{"brain", Part::organ, "brain"},
};

struct Direction {
    const char* word;
    std::array<double, 3> lps;
};
constexpr std::array directions{Direction{"anterior", {0, -1, 0}}, Direction{"posterior", {0, 1, 0}},
                                Direction{"left", {1, 0, 0}},      Direction{"right", {-1, 0, 0}},
                                Direction{"superior", {0, 0, 1}},  Direction{"inferior", {0, 0, -1}}};

std::string lower(std::string_view name) {
    std::string text(name);
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

}  // namespace

Anatomy anatomy_of(std::string_view name, const Eigen::Vector3d& approach) {
    const std::string text = lower(name);
    Anatomy anatomy{.part = Part::organ,
                    .tissue = "",
                    .held_towards = Eigen::Vector3d::Zero() - approach,
                    .why_held = "the side away from the approach"};
    const auto word = std::ranges::find_if(
        words, [&](const Word& w) { return text.find(w.part_of_name) != std::string::npos; });
    if (word != words.end()) {
        anatomy.part = word->part;
        anatomy.tissue = word->tissue;
    }
    if (anatomy.part == Part::organ && anatomy.tissue == "liver") {
        anatomy.held_towards = Eigen::Vector3d(0, 1, 1).normalized();
        anatomy.why_held =
            "the posterior superior part, where the liver grows onto the diaphragm (its bare area)";
    }
    return anatomy;
}

Eigen::Vector3d direction_of(const std::string& word, const std::string& option) {
    const auto found = std::ranges::find(directions, lower(word), &Direction::word);
    if (found == directions.end())
        throw UsageError(
            {option, "'" + word + "'", "anterior, posterior, left, right, superior or inferior", ""});
    return {found->lps[0], found->lps[1], found->lps[2]};
}

}  // namespace palpate::draft
