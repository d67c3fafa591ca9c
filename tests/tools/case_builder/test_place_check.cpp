// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tools/case_builder/checks/place_check.hpp"

namespace palpate::case_builder {
namespace {

using nlohmann::ordered_json;

// A case on a volume of 50 x 50 x 50 voxels of 2 mm from the origin on, whose liver lies in its middle.
std::string case_of(const std::string& structure, const std::string& fixed) {
    return "schema = 1\nname = \"liver\"\n[input]\nvolume = \"ct.nrrd\"\n[[structure]]\nname = "
           "\"liver\"\nrecipe = \"liver\"\n" +
           structure + "\n[[deformable]]\nname = \"liver\"\nmesh = { cell_size_mm = 8 }\nfixed = [" + fixed +
           "]\n[[deformable.region]]\nlabel = \"Liver\"\nyoungs_modulus_kpa = 6\npoissons_ratio = 0.45\n";
}

StageRecord imported() {
    return {.name = "import volume",
            .result = {{"grid",
                        {{"size", {50, 50, 50}},
                         {"spacing_mm", {2, 2, 2}},
                         {"origin_mm", {0, 0, 0}},
                         {"direction_columns", {1, 0, 0, 0, 1, 0, 0, 0, 1}}}}}};
}

StageRecord segmented() {
    return {.name = "segment",
            .result = {{"labels",
                        {{{"name", "liver"},
                          {"value", 1},
                          {"voxels", 8000},
                          {"volume_ml", 64},
                          {"box_min_mm", {30, 30, 30}},
                          {"box_max_mm", {68, 68, 68}}}}}}};
}

std::string mistakes_of(const std::string& text, const std::vector<StageRecord>& done) {
    const sample::Scratch scratch;
    std::ofstream(scratch / "case.toml") << text;
    const CaseFile case_file = read_case_file(scratch / "case.toml");
    PlaceCheck places(scratch / "case.toml", case_file, {});
    std::filesystem::remove(scratch / "case.toml");  // what becomes of it meanwhile is another case
    try {
        for (const StageRecord& record : done) places.after(record);
        return "";
    } catch (const InvalidInput& error) {
        return error.what();
    }
}

std::string of_structure(const std::string& lines) {
    return mistakes_of(case_of(lines, "{ touching = \"background\" }"), {imported()});
}
std::string of_rule(const std::string& fixed) {
    return mistakes_of(case_of("seeds_mm = [50, 50, 50]", fixed), {imported(), segmented()});
}

TEST(PlaceCheck, places_in_the_image_and_at_the_body_pass) {
    EXPECT_EQ(of_structure("seeds_mm = [50, 50, 50, 0, 0, 98]"), "");
    EXPECT_EQ(of_structure("seeds_mm = [1, 1, 1]\nbox_min_mm = [-9, -9, -9]\nbox_max_mm = [9, 9, 9]"), "");
    for (const char* rule :
         {"{ box_mm = [77, 60, 60, 90, 90, 90] }", "{ sphere_mm = [0, 49, 49, 29] }",
          "{ plane_mm = [0, 0, 60, 0, 0, 1] }", "{ facing = [0, 0, 1] }", "{ touching = \"background\" }"})
        EXPECT_EQ(of_rule(rule), "") << rule;
}

TEST(PlaceCheck, seeds_and_cut_boxes_beside_the_image_are_told_with_their_lines) {
    const std::string told = of_structure(
        "seeds_mm = [50, 50, 50, 50, 50, 100]\nlesion_seeds_mm = [-50, 5, 5]\n"
        "box_min_mm = [200, 0, 0]\nbox_max_mm = [300, 9, 9]");
    EXPECT_NE(told.find("case.toml: has 3 mistakes"), std::string::npos) << told;
    EXPECT_NE(told.find("case.toml:8: structure 'liver': seed (50, 50, 100) mm lies outside"),
              std::string::npos)
        << told;
    EXPECT_NE(told.find("case.toml:9: structure 'liver': seed (-50, 5, 5) mm"), std::string::npos) << told;
    EXPECT_NE(told.find("case.toml:10: key 'box_min_mm'"), std::string::npos) << told;
}

TEST(PlaceCheck, rules_beside_their_body_are_told_with_where_it_lies) {
    for (const auto& [rule, kind] : {std::pair("{ box_mm = [79, 60, 60, 90, 90, 90] }", "box_mm"),
                                     {"{ sphere_mm = [0, 49, 49, 19] }", "sphere_mm"},
                                     {"{ plane_mm = [0, 0, 79, 0, 0, 1] }", "plane_mm"},
                                     {"{ plane_mm = [0, 0, 19, 0, 0, -1] }", "plane_mm"}}) {
        const std::string told = of_rule(rule);
        EXPECT_NE(told.find("case.toml:12: key 'fixed'"), std::string::npos) << told;
        EXPECT_NE(told.find(std::string(kind) + " that lies beside 'liver'"), std::string::npos) << told;
        EXPECT_NE(told.find("between (20, 20, 20) and (78, 78, 78) mm"), std::string::npos) << told;
    }
}

TEST(PlaceCheck, the_end_of_a_body_of_thick_slices_is_no_place_beside_it) {
    StageRecord thick = imported();
    thick.result["grid"]["spacing_mm"] = {0.7, 0.7, 9};
    // The last slice's middle is at 68 mm, and its voxels end at 72.5.
    const std::string text = case_of("seeds_mm = [5, 5, 5]", "{ plane_mm = [0, 0, 76, 0, 0, 1] }");
    EXPECT_EQ(mistakes_of(text, {thick, segmented()}), "");
}

TEST(PlaceCheck, other_stages_and_the_label_map_of_two_images_tell_no_place) {
    const std::string text = case_of("seeds_mm = [500, 50, 50]", "{ box_mm = [500, 0, 0, 501, 1, 1] }");
    StageRecord labels = imported(), mesh = segmented();
    labels.name = "import labels";
    mesh.name = "mesh liver";
    EXPECT_EQ(mistakes_of(text, {labels}), "");
    EXPECT_EQ(mistakes_of(text, {mesh}), "");
    EXPECT_NE(mistakes_of(text, {imported()}), "");
}

}  // namespace
}  // namespace palpate::case_builder
