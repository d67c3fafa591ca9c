// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/tissue/tissue_colours.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <string>

#include "formats/model/regions.hpp"

namespace palpate::visual {
namespace {

struct Known {
    std::string_view word;  // that a name's words begin with
    TissueLook look;
};

const TissueLook bone{{226, 211, 180}, 0.1F}, cartilage{{190, 205, 212}, 0.4F}, muscle{{142, 62, 52}, 0.3F},
    fat{{226, 190, 104}, 0.35F}, vein{{82, 88, 140}, 0.45F}, artery{{190, 52, 46}, 0.45F},
    gut{{208, 150, 128}, 0.5F}, gland{{214, 166, 124}, 0.35F}, mucosa{{204, 118, 108}, 0.6F},
    brain{{218, 184, 172}, 0.45F}, nerve{{228, 214, 168}, 0.3F}, tumour{{206, 190, 164}, 0.25F};

// By word; several words belong to one tissue.
const auto& known() {
    static const auto table = std::to_array<Known>({
        {"liver", {{122, 58, 47}, 0.36F}},
        {"gallbladder", {{108, 134, 88}, 0.55F}},
        {"kidney", {{166, 96, 76}, 0.36F}},
        {"spleen", {{112, 56, 78}, 0.5F}},
        {"heart", {{160, 70, 58}, 0.5F}},
        {"atrial appendage", {{160, 70, 58}, 0.5F}},
        {"lung", {{216, 160, 152}, 0.35F}},
        {"brain", brain},
        {"hippocampus", brain},
        {"spinal cord", nerve},
        {"nerve", nerve},
        {"skin", {{220, 176, 150}, 0.15F}},
        {"face", {{220, 176, 150}, 0.15F}},
        {"bladder", {{216, 160, 140}, 0.5F}},
        {"prostate", gland},
        {"pancreas", gland},
        {"adrenal", gland},
        {"thyroid", {{164, 84, 70}, 0.4F}},
        {"gland", gland},
        {"stomach", gut},
        {"esophagus", gut},
        {"oesophagus", gut},
        {"duodenum", gut},
        {"bowel", gut},
        {"colon", gut},
        {"intestine", gut},
        {"rectum", gut},
        {"wall", mucosa},
        {"mucosa", mucosa},
        {"nasopharynx", mucosa},
        {"pharynx", mucosa},
        {"airway", mucosa},
        {"trachea", {{214, 160, 150}, 0.55F}},
        {"bronch", {{214, 160, 150}, 0.55F}},
        {"tongue", mucosa},
        {"tumour", tumour},
        {"tumor", tumour},
        {"lesion", tumour},
        {"mass", tumour},
        {"metastas", tumour},
        {"cyst", {{176, 196, 200}, 0.6F}},
        {"artery", artery},
        {"aorta", artery},
        {"carotid", artery},
        {"trunk", artery},
        {"vein", vein},
        {"vena", vein},
        {"vessel", vein},
        {"bone", bone},
        {"skull", bone},
        {"mandible", bone},
        {"teeth", {{238, 232, 214}, 0.4F}},
        {"vertebra", bone},
        {"rib", bone},
        {"sternum", bone},
        {"sacrum", bone},
        {"hip", bone},
        {"pelvis", bone},
        {"femur", bone},
        {"tibia", bone},
        {"fibula", bone},
        {"humerus", bone},
        {"radius", bone},
        {"ulna", bone},
        {"scapula", bone},
        {"clavicul", bone},
        {"clavicle", bone},
        {"cartilage", cartilage},
        {"disc", cartilage},
        {"muscle", muscle},
        {"gluteus", muscle},
        {"masseter", muscle},
        {"iliopsoas", muscle},
        {"autochthon", muscle},
        {"quadriceps", muscle},
        {"sartorius", muscle},
        {"diaphragm", muscle},
        {"fat", fat},
        {"adipose", fat},
    });
    return table;
}

// Lower case, with one blank before each word and none else: digits and marks part words.
std::string words_of(std::string_view name) {
    std::string words = " ";
    for (const char letter : name) {
        if (std::isalpha(static_cast<unsigned char>(letter)))
            words += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
        else if (words.back() != ' ')
            words += ' ';
    }
    return words;
}

// FNV-1a, by Fowler, Noll and Vo: the same on every machine.
std::uint32_t hash_of(std::string_view text) {
    std::uint32_t hash = 2166136261U;
    for (const char letter : text) hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619U;
    return hash;
}

Rgb rgb_of(const Colour& colour) {
    return {static_cast<float>(colour[0]), static_cast<float>(colour[1]), static_cast<float>(colour[2])};
}

Rgb muted_colour(std::uint32_t hash) {
    const auto turn = static_cast<float>(hash % 360) / 360;
    const auto lightness = static_cast<float>(130 + hash / 360 % 60);
    Rgb colour;
    for (int channel = 0; channel < 3; ++channel) {
        const float way =
            std::abs(std::remainder(turn - static_cast<float>(channel) / 3, 1.0F));  // 0 ... 0.5
        colour[channel] = lightness * (1.2F - 0.9F * way);
    }
    return colour;
}

}  // namespace

TissueLook tissue_look(std::string_view name) {
    const std::string words = words_of(name);
    // The last one counts, as in 'kidney_cyst_left', and of two that begin together the longer one.
    const auto end_of = [&](const Known& entry) {
        const std::size_t at = words.rfind(" " + std::string(entry.word));
        return at == std::string::npos ? std::size_t{0} : at + entry.word.size();
    };
    const Known& last = *std::ranges::max_element(known(), {}, end_of);
    return end_of(last) > 0 ? last.look : TissueLook{muted_colour(hash_of(words))};
}

std::optional<Rgb> chosen_colour(const DeformableBody& body, std::int32_t region) {
    const auto chosen = std::ranges::find(body.region_colours, region, &RegionColour::region);
    return chosen == body.region_colours.end() ? std::nullopt : std::optional(rgb_of(chosen->colour));
}

TissueLook look_of(const RigidBody& body) {
    TissueLook look = tissue_look(body.name);
    if (body.colour) look.colour = rgb_of(*body.colour);
    return look;
}

TissueLook look_of(const DeformableBody& body) {
    const std::int32_t main = main_region(body.mesh);
    const auto label = find_label(body.mesh.region_names, std::to_string(main));
    TissueLook look = tissue_look(label ? label->name : body.name);
    if (body.colour) look.colour = rgb_of(*body.colour);
    look.colour = chosen_colour(body, main).value_or(look.colour);
    return look;
}

}  // namespace palpate::visual
