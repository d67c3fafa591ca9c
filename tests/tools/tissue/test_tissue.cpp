// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tools/tissue/tissue.hpp"

namespace palpate::tissue {
namespace {

TEST(Tissue, presets_are_materials_that_can_be_condensed_and_name_a_source) {
    for (const Tissue& tissue : tissues()) {
        const Material material{.youngs_modulus = tissue.youngs_modulus_kpa * 1e-3,
                                .poissons_ratio = tissue.poissons_ratio};
        EXPECT_FALSE(first_error(material_fields, material)) << tissue.name;
        EXPECT_FALSE(relaxation_error(tissue.relaxation)) << tissue.name;
        EXPECT_LE(least_soft_kpa, tissue.least_kpa) << tissue.name;
        EXPECT_LE(tissue.least_kpa, tissue.youngs_modulus_kpa) << tissue.name;
        EXPECT_LE(tissue.youngs_modulus_kpa, tissue.most_kpa) << tissue.name;
        EXPECT_LE(tissue.most_kpa, most_soft_kpa) << tissue.name;
        EXPECT_GT(tissue.density_kg_m3, 200) << tissue.name;
        EXPECT_LT(tissue.density_kg_m3, 1200) << tissue.name;
        EXPECT_FALSE(tissue.meaning.empty()) << tissue.name;
        EXPECT_FALSE(tissue.source.empty()) << tissue.name;
        // An asset's provenance refuses slashes, for they may part folders of whoever made it.
        EXPECT_EQ(tissue.source.find_first_of("/\\"), std::string::npos) << tissue.name;
    }
}

TEST(Tissue, names_are_in_order_and_a_wrong_one_is_answered_with_the_nearest) {
    EXPECT_TRUE(std::ranges::is_sorted(tissues(), {}, &Tissue::name));
    EXPECT_EQ(require_tissue("liver", "x").name, "liver");
    try {
        require_tissue("lever", "case.toml:3");
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("case.toml:3"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("liver"), std::string::npos);
    }
}

}  // namespace
}  // namespace palpate::tissue
