// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>

#include "formats/model/errors.hpp"
#include "tools/draft/anatomy.hpp"
#include "tools/draft/case_draft.hpp"

namespace palpate::draft {
namespace {

using Eigen::Vector3d;

const Vector3d from_the_front(0, -1, 0);

struct Ball {
    std::string name;
    Vector3d centre;  // mm
    double radius;    // mm
};

// Balls on a grid of 2 mm, later ones over earlier ones.
LabelMap map_of(const std::vector<Ball>& balls) {
    LabelMap map;
    map.grid = {.size = {60, 60, 60}, .spacing = Vector3d::Constant(2), .origin = Vector3d::Constant(-60)};
    map.labels.assign(map.grid.voxel_count(), 0);
    for (const Ball& ball : balls) {
        map.names.push_back({static_cast<std::int32_t>(map.names.size() + 1), ball.name});
        for (std::int32_t k = 0; k < 60; ++k)
            for (std::int32_t j = 0; j < 60; ++j)
                for (std::int32_t i = 0; i < 60; ++i)
                    if ((map.grid.point_of(Vector3d(i, j, k)) - ball.centre).norm() < ball.radius)
                        map.labels[map.grid.offset(i, j, k)] =
                            static_cast<std::uint16_t>(map.names.back().value);
    }
    return map;
}

const Ball liver{"liver", {0, 0, 0}, 30}, tumour{"liver_tumor", {5, 0, 0}, 8},
    kidney{"kidney_right", {0, 42, -20}, 14}, far{"spleen", {52, 52, 52}, 7},
    lung{"lung_left", {0, 0, 48}, 16};

std::vector<std::string> labels_of(const CaseDraft& draft) {
    std::vector<std::string> labels;
    for (const DraftRegion& region : draft.regions) labels.push_back(region.label);
    return labels;
}

TEST(Anatomy, reads_names_as_segmenters_write_them) {
    EXPECT_EQ(anatomy_of("Liver", from_the_front).tissue, "liver");
    EXPECT_EQ(anatomy_of("liver_tumor", from_the_front).part, Part::lesion);
    EXPECT_EQ(anatomy_of("portal_vein_and_splenic_vein", from_the_front).part, Part::vessel);
    EXPECT_EQ(anatomy_of("vertebrae_L3", from_the_front).part, Part::bone);
    EXPECT_EQ(anatomy_of("lung_lower_lobe_right", from_the_front).part, Part::aside);
    for (const char* preset : {"kidney", "spleen", "pancreas", "brain"})
        EXPECT_EQ(anatomy_of(std::string("left_") + preset, from_the_front).tissue, preset);
    EXPECT_EQ(anatomy_of("kidney_tumour", from_the_front).part, Part::lesion);
    const Anatomy unknown = anatomy_of("stomach", from_the_front);
    EXPECT_EQ(unknown.part, Part::organ);
    EXPECT_EQ(unknown.tissue, "");
    EXPECT_EQ(unknown.held_towards, Vector3d(0, 1, 0));
    EXPECT_EQ(direction_of("Right", "x"), Vector3d(-1, 0, 0));
    EXPECT_THROW(direction_of("up", "x"), UsageError);
}

TEST(CaseDraft, takes_the_organ_with_its_lesions_and_what_lies_beside_it) {
    const CaseDraft draft =
        draft_case(map_of({liver, tumour, kidney, far, lung}), {.organ = "", .contact_nodes = 300}, "x");
    EXPECT_EQ(draft.name, "liver");
    EXPECT_EQ(labels_of(draft), (std::vector<std::string>{"liver", "liver_tumor"}));
    EXPECT_EQ(draft.regions[0].tissue, "liver");
    EXPECT_LT(draft.regions[1].cell_size, draft.cell_size);
    ASSERT_EQ(draft.rigid.size(), 1U);
    EXPECT_EQ(draft.rigid[0].label, "kidney_right");
    ASSERT_EQ(draft.structures.size(), 3U);
    EXPECT_EQ(draft.structures[0].name, "liver_tumor");  // before the organ closes over it
    const std::string text = case_text(draft);
    EXPECT_NE(text.find("cell_size_mm = " + fmt::format("{:g}", draft.cell_size)), std::string::npos) << text;
    EXPECT_NE(text.find("\n[quality]\n"), std::string::npos) << text;
}

TEST(CaseDraft, cells_follow_from_the_surface_and_the_nodes_that_are_wanted) {
    const LabelMap map = map_of({liver});
    const CaseDraft coarse = draft_case(map, {.organ = "", .contact_nodes = 200}, "x"),
                    fine = draft_case(map, {.organ = "", .contact_nodes = 800}, "x");
    EXPECT_NEAR(coarse.area_cm2, 4 * std::numbers::pi * 9, 0.05 * 4 * std::numbers::pi * 9);
    EXPECT_NEAR(coarse.cell_size, 2 * fine.cell_size, 0.35);  // to a quarter, and twice 0.05 mm
    const CaseDraft finest = draft_case(map, {.organ = "", .contact_nodes = 1e6}, "x");
    EXPECT_EQ(finest.cell_size, 2);    // the voxels'
    EXPECT_EQ(finest.tool_radius, 2);  // and so the tool, which would feel them if it were smaller
}

TEST(CaseDraft, holds_an_eighth_of_the_surface_on_the_side_away_from_the_approach) {
    const Wishes from_the_right{.organ = "spleen", .approach = {-1, 0, 0}};
    const CaseDraft draft = draft_case(map_of({{"spleen", {0, 0, 0}, 30}}), from_the_right, "x");
    EXPECT_EQ(draft.held_towards, Vector3d(1, 0, 0));
    // Beyond x a ball's cap has (1 - x / r) / 2 of its surface; faces of voxels tell it to a voxel.
    EXPECT_NEAR(draft.held_at.x(), 30 * (1 - 2 * 0.12), 2);
}

TEST(CaseDraft, holds_what_is_long_all_along) {
    std::vector<Ball> row;  // a bow whose middle alone lies on the side away from the approach
    for (double z = -52; z <= 52; z += 4) row.push_back({"aorta", {0, 30 - z * z / 40, z}, 6});
    LabelMap map = map_of({row.begin(), row.end()});
    std::ranges::replace_if(
        map.labels, [](std::uint16_t label) { return label > 0; }, std::uint16_t{1});
    map.names.resize(1);
    const CaseDraft draft = draft_case(map, {.organ = "aorta"}, "x");
    EXPECT_TRUE(draft.held_along);
    EXPECT_NE(case_text(draft).find("fixed = [{ facing = [0.000, 1.000, 0.000] }]\n"), std::string::npos)
        << case_text(draft);
    EXPECT_FALSE(draft_case(map_of({{"spleen", {0, 0, 0}, 30}}), {}, "x").held_along);
}

TEST(CaseDraft, looks_at_the_largest_piece_alone) {
    const Ball splinter{"spleen", {0, -50, 0}, 6};
    LabelMap map = map_of({{"spleen", {0, 0, 0}, 20}, splinter});
    std::ranges::replace(map.labels, std::uint16_t{2}, std::uint16_t{1});
    map.names.pop_back();
    EXPECT_NEAR(draft_case(map, {}, "x").volume_ml, 33.5, 1);
}

TEST(CaseDraft, an_organ_that_is_not_there_or_not_known_is_asked_for) {
    const auto message = [](const LabelMap& map, const std::string& organ) {
        try {
            draft_case(map, {.organ = organ}, "l.nrrd");
            return std::string();
        } catch (const InvalidInput& error) {
            return std::string(error.what());
        }
    };
    EXPECT_NE(message(map_of({liver, kidney}), "kidney").find("kidney_right"), std::string::npos);
    EXPECT_NE(message(map_of({{"label_1", {0, 0, 0}, 9}, {"label_2", {30, 0, 0}, 9}}), "").find("--organ"),
              std::string::npos);
    EXPECT_NE(message(map_of({{"femur_left", {0, 0, 0}, 9}}), "").find("gives way"), std::string::npos);
}

TEST(CaseDraft, tetrahedra_keep_their_regions_and_take_the_tissue_of_the_files_name) {
    TetMesh mesh;
    mesh.rest_positions = {{0, 0, 0}, {30, 0, 0}, {0, 30, 0}, {0, 0, 30}};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    mesh.regions = {4};
    mesh.region_names = {{4, "region 4"}};
    const CaseDraft draft = draft_case(mesh, {}, "liver");
    ASSERT_EQ(draft.regions.size(), 1U);
    EXPECT_EQ(draft.regions[0].mesh_region, 4);
    EXPECT_EQ(draft.regions[0].tissue, "liver");
    EXPECT_NEAR(draft.volume_ml, 4.5, 1e-12);
    EXPECT_TRUE(draft.structures.empty());
    EXPECT_EQ(plausible_unit(180), "mm");
    EXPECT_EQ(plausible_unit(18), "cm");
    EXPECT_EQ(plausible_unit(0.18), "m");
}

}  // namespace
}  // namespace palpate::draft
