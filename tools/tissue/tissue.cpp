// SPDX-License-Identifier: GPL-3.0-or-later
//
// Elastography states shear moduli G; nearly incompressible tissue has E = 3 G. Where a source gives no
// spread, the plausible range is a factor of two and more about its value.
#include "tools/tissue/tissue.hpp"

#include <algorithm>

#include "formats/model/errors.hpp"
#include "formats/model/label_map.hpp"

namespace palpate::tissue {
namespace {

const std::vector<Tissue>& all_tissues() {
    static const std::vector<Tissue> all{
        {.name = "liver",
         .meaning = "healthy, adults, in vivo",
         .youngs_modulus_kpa = 6.3,
         .least_kpa = 3,
         .most_kpa = 12,
         .poissons_ratio = 0.45,
         .density_kg_m3 = 1060,
         .relaxation = {},
         .source = "G 2.09 +- 0.22 kPa of 41 by MR elastography, J Magn Reson Imaging 39:1-8, 2014; 1.37 to "
                   "2.66 of 102, Obrzut et al., Pol Arch Intern Med; density ICRU Report 46"},
        {.name = "liver-fibrotic",
         .meaning = "fibrotic, in vivo",
         .youngs_modulus_kpa = 17.7,
         .least_kpa = 9,
         .most_kpa = 60,
         .poissons_ratio = 0.45,
         .density_kg_m3 = 1060,
         .relaxation = {},
         .source =
             "G 5.9 kPa by MR elastography beside 44 solid tumours, PMC2894569; density ICRU Report 46"},
        {.name = "liver-tumour",
         .meaning = "malignant, in vivo",
         .youngs_modulus_kpa = 30,
         .least_kpa = 12,
         .most_kpa = 80,
         .poissons_ratio = 0.45,
         .density_kg_m3 = 1060,
         .relaxation = {},
         .source = "G 10.1 kPa by MR elastography of 44 solid tumours, PMC2894569; density that of liver"},
        {.name = "liver-tumour-benign",
         .meaning = "benign, in vivo",
         .youngs_modulus_kpa = 8.1,
         .least_kpa = 4,
         .most_kpa = 20,
         .poissons_ratio = 0.45,
         .density_kg_m3 = 1060,
         .relaxation = {},
         .source = "G 2.7 kPa by MR elastography of 44 solid tumours, PMC2894569; density that of liver"},
        {.name = "soft-palate",
         .meaning = "stands in for the nasopharyngeal wall, of which no measurement was found",
         .youngs_modulus_kpa = 7.8,
         .least_kpa = 4,
         .most_kpa = 20,
         .poissons_ratio = 0.45,
         .density_kg_m3 = 1050,
         .relaxation = {},
         .source =
             "G' 2.53 +- 0.31 kPa (soft palate) and 2.67 +- 0.29 (tongue) by MR elastography, J Biomech "
             "44:450-454, 2011; density that of muscle, ICRU Report 46"},
    };
    return all;
}

}  // namespace

std::span<const Tissue> tissues() {
    return all_tissues();
}

const Tissue& require_tissue(const std::string& name, const std::string& culprit) {
    const auto found = std::ranges::find(tissues(), name, &Tissue::name);
    if (found != tissues().end()) return *found;
    std::vector<std::string> names;
    for (const Tissue& tissue : tissues()) names.push_back(tissue.name);
    std::string nearest;
    for (const std::string& near : nearest_names(name, names))
        nearest += (nearest.empty() ? "nearest: " : ", ") + near;
    throw InvalidInput(
        {culprit, "there are no values of '" + name + "'", "", nearest + "; 'palpate tissues' lists all"});
}

}  // namespace palpate::tissue
