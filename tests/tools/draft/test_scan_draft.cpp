// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "sample_data/phantoms.hpp"
#include "tools/draft/scan_draft.hpp"

namespace palpate::draft {
namespace {

using Eigen::Vector3d;

CaseDraft draft_of(const Volume& volume, const std::string& organ, const ScanSeeds& seeds) {
    return draft_scan(volume, true, seeds, {.organ = organ, .contact_nodes = 500}, "ct.nrrd", {}, {});
}

TEST(ScanDraft, of_a_head_has_the_wall_about_the_click_held_by_bone) {
    const CaseDraft draft = draft_of(head_phantom().volume, "nasopharynx", {{"0,-5,-40"}, {}, {}, ""});
    EXPECT_EQ(draft.name, "nasopharynx");
    ASSERT_EQ(draft.structures.size(), 3U);
    EXPECT_NE(draft.structures[1].recipe.find("seeds_mm = [0, -5, -40]\n"), std::string::npos);
    EXPECT_NE(draft.structures[2].recipe.find("center_mm = [0, -5, -40]\n"), std::string::npos);
    EXPECT_GT(draft.volume_ml, 5);
    EXPECT_EQ(draft.regions.front().tissue, "soft-palate");
    const std::string text = case_text(draft);
    for (const char* line : {"fixed = [{ touching = \"skull\" }, { touching = \"background\" }]\n",
                             "[[rigid]]\nname = \"skull\"\nlabel = \"skull\"\nisovalue_hu = 226.0\n",
                             "recipe = \"nasopharynx\"\nair = \"airway\"\n"})
        EXPECT_NE(text.find(line), std::string::npos) << text;
}

TEST(ScanDraft, has_what_segment_finds_of_the_same_seeds) {
    const CaseDraft alone = draft_of(abdomen_phantom().volume, "spleen", {{"-4,-8,0"}, {}, {}, ""});
    EXPECT_EQ(alone.structures.front().recipe, "recipe = \"organ\"\nseeds_mm = [-4, -8, 0]\n");
    const CaseDraft against =
        draft_of(abdomen_phantom().volume, "liver", {{"10,0,0"}, {"-50,-50,0", "50,50,0"}, {}, ""});
    EXPECT_NE(against.structures.front().recipe.find("recipe = \"grow-from-seeds\"\n"), std::string::npos);
    EXPECT_NE(against.structures.front().recipe.find("background_mm = [-50, -50, 0, 50, 50, 0]\n"),
              std::string::npos);
    EXPECT_GT(against.volume_ml, 30);
}

TEST(ScanRecipes, look_for_a_nasopharynx_in_a_ct_alone) {
    EXPECT_THROW(scan_recipes("nasopharynx", false, false, Vector3d::Zero()), UsageError);
    EXPECT_EQ(scan_recipes("liver", true, false, Vector3d::Zero()).structures.front(),
              "liver: recipe=liver keep_largest=yes");
    EXPECT_TRUE(scan_recipes("liver", false, false, Vector3d::Zero())
                    .structures.front()
                    .starts_with("liver: recipe=organ"));
}

}  // namespace
}  // namespace palpate::draft
