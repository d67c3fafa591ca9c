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
        {.name = "brain",
         .meaning = "healthy, adults, in vivo, at some 60 Hz; slow tests find a third and less",
         .youngs_modulus_kpa = 9.2,
         .least_kpa = 1.5,
         .most_kpa = 12,
         .poissons_ratio = 0.45,
         .density_kg_m3 = 1040,
         .relaxation = {},
         .source = "median G 3.07 kPa of 10 by MR elastography, 2.37 of 14 aged, Murphy et al., PMC3217096; "
                   "least by "
                   "excised tissue of 0.5 to 1.4 kPa, Budday et al., Acta Biomater 48:319-340, 2017; density "
                   "that of "
                   "GATE's materials"},
        {.name = "kidney",
         .meaning = "healthy, adults, in vivo",
         .youngs_modulus_kpa = 12,
         .least_kpa = 6,
         .most_kpa = 30,
         .poissons_ratio = 0.45,
         .density_kg_m3 = 1050,
         .relaxation = {},
         .source = "shear waves of 1.93 +- 0.22 m per s in 9 by MR elastography, Magn Reson Med 78:976-983, "
                   "2017; G 4.9 "
                   "+- 0.5 kPa at 45 Hz and 9.4 +- 0.8 at 76 of 10, J Magn Reson Imaging 34:880-886, 2011; "
                   "density ICRU "
                   "Report 46"},
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
        {.name = "pancreas",
         .meaning = "healthy, adults, in vivo",
         .youngs_modulus_kpa = 3.4,
         .least_kpa = 2,
         .most_kpa = 8,
         .poissons_ratio = 0.45,
         .density_kg_m3 = 1040,
         .relaxation = {},
         .source =
             "G 1.14 +- 0.13 kPa by MR elastography at 40 Hz, 2.08 +- 0.31 at 60 Hz elsewhere, J Magn Reson "
             "Imaging 52:448-458, 2020; density that of GATE's materials"},
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
        {.name = "spleen",
         .meaning = "healthy, adults, in vivo",
         .youngs_modulus_kpa = 11.7,
         .least_kpa = 7,
         .most_kpa = 17,
         .poissons_ratio = 0.45,
         .density_kg_m3 = 1060,
         .relaxation = {},
         .source = "the middle of G 3.57 +- 0.59 and 4.26 +- 0.63 kPa (driver right, left) of 16 by MR "
                   "elastography at "
                   "60 Hz, Am J Roentgenol 195:387-392, 2010; density that of GATE's materials"},
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
