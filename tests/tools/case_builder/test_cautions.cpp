// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tools/case_builder/cautions.hpp"
#include "tools/tissue/tissue.hpp"

namespace palpate::case_builder {
namespace {

CaseFile read(const std::string& region, const std::string& more = "") {
    const sample::Scratch scratch;
    std::ofstream(scratch / "case.toml") << "schema = 1\nname = \"x\"\n[[deformable]]\nname = \"liver\"\n"
                                            "[[deformable.region]]\nlabel = \"organ\"\n"
                                         << region << more;
    return read_case_file(scratch / "case.toml");
}

const stages::CondenseRequest& condense_of(const CaseFile& file) {
    return file.deformable.at(0).condense;
}

bool one_holds(const std::vector<std::string>& sentences, const std::string& phrase) {
    return std::ranges::any_of(
        sentences, [&](const std::string& sentence) { return sentence.find(phrase) != std::string::npos; });
}

TEST(Tissues, a_region_takes_its_values_from_the_preset_that_it_names) {
    const tissue::Tissue& liver = tissue::require_tissue("liver", "");
    const CaseFile file = read("tissue = \"liver\"\n");
    const stages::LabelMaterial& material = condense_of(file).materials.at(0);
    EXPECT_EQ(material.label, "organ");
    EXPECT_EQ(material.youngs_modulus_kpa, liver.youngs_modulus_kpa);
    EXPECT_EQ(material.poissons_ratio, liver.poissons_ratio);
    EXPECT_EQ(condense_of(file).densities.at(0).density_kg_m3, liver.density_kg_m3);
    EXPECT_EQ(condense_of(file).relaxation.size(), liver.relaxation.size());
    EXPECT_TRUE(doubts_of(file).empty());
    EXPECT_TRUE(one_holds(cautions_of(file), liver.source));
}

TEST(Tissues, what_is_written_beside_a_preset_goes_before_it) {
    const CaseFile file = read(
        "tissue = \"liver\"\nyoungs_modulus_kpa = 5\npoissons_ratio = 0.4\ndensity_kg_m3 = 1000\n"
        "relaxation = [{ share = 0.5, time_s = 2 }]\n");
    EXPECT_EQ(condense_of(file).materials.at(0).youngs_modulus_kpa, 5);
    EXPECT_EQ(condense_of(file).materials.at(0).poissons_ratio, 0.4);
    EXPECT_EQ(condense_of(file).densities.at(0).density_kg_m3, 1000);
    ASSERT_EQ(condense_of(file).relaxation.size(), 1U);
    EXPECT_EQ(condense_of(file).relaxation[0].term.share, 0.5);
    EXPECT_TRUE(condense_of(read("tissue = \"liver\"\nrelaxation = []\n")).relaxation.empty());
    EXPECT_TRUE(one_holds(cautions_of(file), "5 kPa and Poisson's ratio 0.4 are the case file's"));
}

TEST(Tissues, a_wrong_name_is_refused_with_line_and_the_nearest) {
    try {
        read("tissue = \"lever\"\n");
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("case.toml:7"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("did you mean liver"), std::string::npos) << error.what();
    }
}

TEST(Cautions, implausible_values_are_questioned_with_what_is_plausible) {
    const std::string pascal = "youngs_modulus_kpa = 6300\npoissons_ratio = 0.45\n";
    EXPECT_TRUE(one_holds(doubts_of(read(pascal)), "6300 kPa is implausible"));
    EXPECT_TRUE(one_holds(doubts_of(read("tissue = \"liver\"\nyoungs_modulus_kpa = 300\n")), "liver has"));
    EXPECT_TRUE(one_holds(doubts_of(read("tissue = \"liver\"\n", "[haptics]\ntool_radius_mm = 0.005\n")),
                          "0.005 mm"));
}

TEST(Cautions, what_is_made_up_or_without_a_source_is_said) {
    const CaseFile file = read("youngs_modulus_kpa = 6\npoissons_ratio = 0.45\n",
                               "[[structure]]\nname = \"tumour\"\nrecipe = \"sphere\"\n");
    EXPECT_TRUE(doubts_of(file).empty());
    EXPECT_TRUE(one_holds(cautions_of(file), "'tumour' is made up"));
    EXPECT_TRUE(one_holds(cautions_of(file), "names no source"));
}

TEST(Cautions, a_scale_to_HU_is_the_case_files_word) {
    CaseFile file;
    EXPECT_TRUE(cautions_of(file).empty());
    file.volume_import.scale = 16.05;
    file.volume_import.offset = -1025;
    EXPECT_TRUE(one_holds(cautions_of(file), "HU = 16.05 x value - 1025 is the case file's"));
}

}  // namespace
}  // namespace palpate::case_builder
