// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "sample_data/phantoms.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/tools/refusal_of.hpp"
#include "tools/imaging/voxels/grow_from_seeds.hpp"
#include "tools/imaging/voxels/seeds.hpp"

namespace palpate {
namespace {

using namespace imaging;

std::filesystem::path written(const sample::Scratch& scratch, const std::string& name,
                              const std::string& text) {
    const std::filesystem::path path = scratch / name;
    std::ofstream(path) << text;
    return path;
}

const std::string slicer_list =
    R"({"@schema": "x", "markups": [{"type": "Fiducial", "coordinateSystem": "RAS",
    "coordinateUnits": "mm", "controlPoints": [
    {"id": "1", "label": "liver-1", "position": [1.5, 2, 3], "positionStatus": "defined"},
    {"id": "2", "label": "", "position": [4, 5, 6]},
    {"id": "3", "label": "liver-3", "position": [0, 0, 0], "positionStatus": "undefined"}]}]})";

TEST(Seeds, of_slicers_json_are_turned_to_lps_and_named_without_their_number) {
    const sample::Scratch scratch;
    const auto seeds = read_seeds(written(scratch, "lesion.mrk.json", slicer_list));
    ASSERT_EQ(seeds.size(), 2U);
    EXPECT_EQ(seeds[0].label, "liver");
    EXPECT_EQ(seeds[0].p_P, Eigen::Vector3d(-1.5, -2, 3));
    EXPECT_EQ(seeds[1].label, "lesion");  // the file's name stands in
}

TEST(Seeds, of_fcsv_follow_the_coordinate_system_of_the_header) {
    const sample::Scratch scratch;
    const std::string columns = "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n",
                      point = "vtkMRMLMarkupsFiducialNode_0,1,2,3,0,0,0,1,1,1,0,\"left, upper-1\",,\r\n";
    for (const auto& [header, expected] :
         std::vector<std::pair<std::string, Eigen::Vector3d>>{{"# CoordinateSystem = LPS\n", {1, 2, 3}},
                                                              {"# CoordinateSystem = 1\n", {1, 2, 3}},
                                                              {"# CoordinateSystem = RAS\r\n", {-1, -2, 3}},
                                                              {"# CoordinateSystem = 0\n", {-1, -2, 3}},
                                                              {"", {-1, -2, 3}}}) {
        const auto seeds = read_seeds(written(scratch, "points.fcsv", header + columns + point));
        ASSERT_EQ(seeds.size(), 1U);
        EXPECT_EQ(seeds[0].p_P, expected) << header;
        EXPECT_EQ(seeds[0].label, "left, upper");
    }
}

TEST(Seeds, written_are_read_back_alike) {
    const sample::Scratch scratch;
    const std::vector<Seed> seeds{{"liver", {0.1, -2.25, 1e3}}, {"background", {1, 2, 3}},
                                  {"label_5", {1, 2, 3}},       {"vein_2", {1, 2, 3}},
                                  {"x-2", {1, 2, 3}},           {"x-2-3", {1, 2, 3}}};
    write_seeds(scratch / "s.mrk.json", seeds);
    const auto back = read_seeds(scratch / "s.mrk.json");
    ASSERT_EQ(back.size(), seeds.size());
    for (std::size_t i = 0; i < seeds.size(); ++i) {
        EXPECT_EQ(back[i].label, seeds[i].label);
        EXPECT_EQ(back[i].p_P, seeds[i].p_P);
    }
}

TEST(Seeds, are_found_by_the_label_as_written_too) {
    const sample::Scratch scratch;
    const auto seeds =
        read_seeds(written(scratch, "points.fcsv",
                           "1,0,0,1,0,0,0,1,1,1,0,tumour_1,,\n2,0,0,2,0,0,0,1,1,1,0,tumour_2,,\n"
                           "3,0,0,3,0,0,0,1,1,1,0,node-1,,\n4,0,0,4,0,0,0,1,1,1,0,node-2,,\n"));
    ASSERT_EQ(seeds.size(), 4U);
    EXPECT_EQ(seeds_of(seeds, "tumour_2", "x").size(), 1U);
    EXPECT_EQ(seeds_of(seeds, "tumour_2", "x").at(0).p_P[2], 2);
    EXPECT_EQ(seeds_of(seeds, "node", "x").size(), 2U);
    EXPECT_EQ(seeds_of(seeds, "node-2", "x").size(), 1U);
    EXPECT_EQ(seeds_of(seeds, "node-2", "x").at(0).p_P[2], 4);
}

TEST(Seeds, of_fcsv_may_have_blanks_before_numbers_and_a_byte_order_mark) {
    const sample::Scratch scratch;
    const auto seeds = read_seeds(
        written(scratch, "points.fcsv", "\xef\xbb\xbf# CoordinateSystem = LPS\n1, 1.5,\t2 , -3\n"));
    ASSERT_EQ(seeds.size(), 1U);
    EXPECT_EQ(seeds[0].p_P, Eigen::Vector3d(1.5, 2, -3));
}

TEST(Seeds, that_cannot_be_read_are_refused) {
    const sample::Scratch scratch;
    for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
             {"a.mrk.json", "{"},
             {"a.mrk.json", R"({"markups": []})"},
             {"a.mrk.json",
              R"({"markups": [{"coordinateSystem": "IJK", "controlPoints": [{"position": [1,2,3]}]}]})"},
             {"a.mrk.json",
              R"({"markups": [{"coordinateUnits": "cm", "controlPoints": [{"position": [1,2,3]}]}]})"},
             {"a.mrk.json", R"({"markups": [{"controlPoints": [{"position": [1,2]}]}]})"},
             {"a.mrk.json", R"({"markups": [{"controlPoints": [{"position": ["x",2,3]}]}]})"},
             {"a.mrk.json", R"({"markups": 3})"},
             {"a.fcsv", "# CoordinateSystem = 2\nid,1,2,3\n"},
             {"a.fcsv", "id,1,x,3\n"},
             {"a.fcsv", "id,1\n"},
             {"a.fcsv", "id,nan,1,2\n"},
             {"a.fcsv", "# nothing\n"},
             {"a.txt", "id,1,2,3\n"}})
        EXPECT_THROW(read_seeds(written(scratch, name, text)), InvalidInput) << name << ": " << text;
    EXPECT_THROW(read_seeds(scratch / "absent.fcsv"), InvalidInput);
    EXPECT_THROW(write_seeds(scratch / "absent" / "a.mrk.json", {}), SystemFailure);
}

TEST(Seeds, that_are_no_points_are_refused_by_what_they_are) {
    const sample::Scratch scratch;
    const std::string first = R"({"position": [1, 2, 3]}, )";
    for (const auto& [point, phrase] : std::vector<std::pair<std::string, std::string>>{
             {R"({"position": null})", "point 2 has the position null (expected three numbers, mm)"},
             {R"({"position": "here"})", "point 2 has the position \"here\""},
             {R"({"position": [1, 2]})", "point 2 has the position [1,2]"},
             {R"({"position": [1, 2, null]})", "point 2 has the position [1,2,null]"},
             {R"({})", "point 2 has the position null"},
             {R"({"position": [1, 2, 3], "label": 4})", "has the label 4 (expected a text)"}}) {
        const auto file =
            written(scratch, "a.mrk.json", R"({"markups": [{"controlPoints": [)" + first + point + "]}]}");
        const std::string said = test::refusal_of([&] { read_seeds(file); });
        EXPECT_NE(said.find(phrase), std::string::npos) << said;
        EXPECT_EQ(said.find("json.exception"), std::string::npos) << said;
    }
    const auto file = written(scratch, "a.mrk.json", R"({"markups": [{"coordinateSystem": 1}]})");
    const std::string said = test::refusal_of([&] { read_seeds(file); });
    EXPECT_NE(said.find("has the coordinateSystem 1 (expected a text)"), std::string::npos) << said;
}

TEST(Seeds, of_a_structure_are_those_with_its_name_or_all_of_a_single_label) {
    const std::vector<Seed> one{{"F", {1, 2, 3}}, {"F", {4, 5, 6}}};
    EXPECT_EQ(seeds_of(one, "liver", "x").size(), 2U);
    const std::vector<Seed> two{{"Liver", {1, 2, 3}}, {"spleen", {4, 5, 6}}};
    EXPECT_EQ(seeds_of(two, "liver", "x").at(0).p_P, two[0].p_P);
    EXPECT_THROW(seeds_of(two, "kidney", "x"), InvalidInput);
}

const std::vector<Seed> abdomen_seeds{{"liver", {-14, -6, 16}}, {"background", {34, 20, 0}}};

TEST(GrowFromSeeds, labels_race_and_background_stays_zero) {
    const Phantom abdomen = abdomen_phantom({.noise_hu = 10});
    const LabelMap map = grow_from_seeds(abdomen.volume, abdomen_seeds);
    ASSERT_EQ(map.names.size(), 1U);
    EXPECT_EQ(map.names[0].name, "liver");
    std::size_t both = 0, sum = 0;
    for (std::size_t i = 0; i < map.labels.size(); ++i) {
        both += map.labels[i] == 1 && abdomen.truth.labels[i] == 1;
        sum += std::size_t{map.labels[i] == 1} + std::size_t{abdomen.truth.labels[i] == 1};
    }
    EXPECT_GT(2.0 * static_cast<double>(both) / static_cast<double>(sum), 0.85);
}

TEST(GrowFromSeeds, a_label_may_have_its_own_tolerance) {
    const Phantom abdomen = abdomen_phantom({.noise_hu = 10});
    const std::vector<Seed> seeds{{"liver", {-14, -6, 16}}, {"rest", {34, 20, 0}}};
    const auto counts = [&](const GrowParameters& parameters) {
        const LabelMap map = grow_from_seeds(abdomen.volume, seeds, parameters);
        return std::pair{std::ranges::count(map.labels, 1), std::ranges::count(map.labels, 2)};
    };
    GrowParameters narrow;
    narrow.tolerances["liver"] = 0.5;
    EXPECT_LT(counts(narrow).first * 2, counts({}).first);
    EXPECT_GE(counts(narrow).second, counts({}).second);
}

TEST(GrowFromSeeds, preview_lies_on_the_volumes_grid_and_has_few_blocks) {
    const Phantom abdomen = abdomen_phantom();
    GrowParameters coarse;
    coarse.spacing_mm = 4.1;
    const LabelMap map = grow_from_seeds(abdomen.volume, abdomen_seeds, coarse);
    EXPECT_TRUE(same_grid(map.grid, abdomen.volume.grid));
    EXPECT_EQ(map.labels.size(), map.grid.voxel_count());
    EXPECT_NE(std::ranges::count(map.labels, 1), 0);
    ImageGrid large;
    large.size = {512, 512, 119};
    large.spacing = {0.8, 0.8, 2.5};
    EXPECT_GT(preview_parameters(large).spacing_mm, 3);
}

TEST(GrowFromSeeds, a_seed_outside_is_refused_with_label_and_place) {
    const Phantom abdomen = abdomen_phantom();
    try {
        grow_from_seeds(abdomen.volume, std::vector<Seed>{{"liver", {1e4, 0, 0}}});
        FAIL() << "nothing was refused";
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("label 'liver': seed (10000, 0, 0) mm lies outside"),
                  std::string::npos)
            << error.what();
    }
    EXPECT_THROW(grow_from_seeds(abdomen.volume, {}), InvalidInput);
}

}  // namespace
}  // namespace palpate
