// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "sample_data/phantoms.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/tools/imaging/hand_written_images.hpp"
#include "tests/tools/imaging/refusals.hpp"
#include "tests/tools/imaging/run_recipes.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/files/label_names.hpp"
#include "tools/imaging/recipes/recipe.hpp"
#include "tools/imaging/recipes/segmentation.hpp"
#include "tools/imaging/voxels/grow_from_seeds.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"
#include "tools/imaging/voxels/label_statistics.hpp"
#include "tools/imaging/voxels/seeds.hpp"

namespace palpate {
namespace {

using namespace imaging;
using namespace test;

const std::vector<std::string> head_recipes{
    "skull: recipe=bone", "airway: recipe=airway seeds_mm=0,-5,-40 opening_mm=4",
    "wall: recipe=nasopharynx center_mm=0,-5,-40 radius_mm=20 thickness_mm=6"};

TEST(Recipes, find_skull_airway_and_wall_of_a_head_however_it_was_imaged) {
    for (const auto& [name, options] : imagings()) {
        SCOPED_TRACE(name);
        const Phantom head = head_phantom(options);
        const LabelMap map = run(&head.volume, nullptr, head_recipes);
        EXPECT_GT(dice(map, "skull", head.truth, "skull"), coarse_dice);
        EXPECT_GT(dice(map, "airway", head.truth, "airway"), coarse_dice);
        EXPECT_GT(dice(map, "wall", head.truth, "wall"), coarse_dice);
        for (const LabelStatistics& label : label_statistics(map)) EXPECT_EQ(label.components, 1U);
    }
}

TEST(Recipes, bone_leaves_the_table_behind) {
    const Phantom abdomen = abdomen_phantom();
    const LabelMap map = run(&abdomen.volume, nullptr, {"bone: recipe=bone"});
    const auto statistics = label_statistics(map);
    EXPECT_LT(statistics[0].box.max()[1], 45);  // the table begins at 50 mm
    LabelMap bones = abdomen.truth;
    for (std::uint16_t& label : bones.labels)
        if (label == 5) label = 4;  // ribs to spine
    EXPECT_GT(dice(map, "bone", bones, "spine"), thick_dice);
}

TEST(Recipes, airway_without_a_seed_is_the_largest_inner_air) {
    const Phantom head = head_phantom();
    const LabelMap seeded = run(&head.volume, nullptr, {head_recipes[1]});
    const LabelMap largest = run(&head.volume, nullptr, {"airway: recipe=airway opening_mm=4"});
    EXPECT_EQ(seeded.labels, largest.labels);
}

TEST(Recipes, threshold_with_region_and_cleaning_finds_a_liver) {
    const Phantom abdomen = abdomen_phantom({.samples_per_axis = 2, .noise_hu = 10});
    const LabelMap map = run(&abdomen.volume, nullptr,
                             {"liver: recipe=threshold lower_hu=80 upper_hu=150 open_mm=2 close_mm=2 "
                              "keep_largest=yes center_mm=-14,-6,0 radius_mm=40"});
    EXPECT_GT(dice(map, "liver", abdomen.truth, "liver"), coarse_dice);
    EXPECT_EQ(label_statistics(map)[0].components, 1U);
}

TEST(Recipes, a_sphere_takes_only_voxels_of_the_structure_it_lies_in) {
    const Phantom abdomen = abdomen_phantom();
    const LabelMap map = run(nullptr, &abdomen.truth,
                             {"liver: recipe=import", "vessels: recipe=import",
                              "ball: recipe=sphere inside=liver center_mm=-14,-6,-10 radius_mm=12"});
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < map.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < map.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < map.grid.size[0]; ++i, ++offset) {
                const double distance =
                    (map.grid.point_of(Eigen::Vector3d(i, j, k)) - Eigen::Vector3d(-14, -6, -10)).norm();
                const bool liver = abdomen.truth.labels[offset] == 1;
                EXPECT_EQ(map.labels[offset] == 3, liver && distance <= 12);
                EXPECT_EQ(map.labels[offset] == 2, abdomen.truth.labels[offset] == 3);
            }
}

TEST(Recipes, import_resamples_from_another_grid) {
    const Phantom fine = abdomen_phantom({.spacing = {1.5, 1.5, 1.5}});
    const Phantom turned = abdomen_phantom({.direction = imagings()[1].options.direction});
    const LabelMap map = run(&turned.volume, &fine.truth, {"organ: recipe=import label=liver"});
    EXPECT_TRUE(same_grid(map.grid, turned.volume.grid));
    EXPECT_GT(dice(map, "organ", turned.truth, "liver"), thick_dice);
}

TEST(Recipes, import_keeps_the_labels_colour) {
    Phantom abdomen = abdomen_phantom();
    for (Label& label : abdomen.truth.names)
        if (label.name == "liver") label.colour = {0.6F, 0.3F, 0.2F};
    const LabelMap map = run(&abdomen.volume, &abdomen.truth, {"organ: recipe=import label=liver"});
    EXPECT_EQ(map.names.at(0).colour, (std::array<float, 3>{0.6F, 0.3F, 0.2F}));
}

TEST(Recipes, bone_finds_a_threshold_clear_of_soft_tissue) {
    const Phantom head = head_phantom({.samples_per_axis = 2, .noise_hu = 25});
    const LabelMap map = run(&head.volume, nullptr, {"skull: recipe=bone threshold_hu=0"});
    EXPECT_GT(dice(map, "skull", head.truth, "skull"), coarse_dice);
}

TEST(Recipes, brain_is_imported_in_one_piece_without_holes) {
    Phantom abdomen = abdomen_phantom();
    const ImageGrid& grid = abdomen.truth.grid;
    const auto offset_at = [&](const Eigen::Vector3d& p) {
        const Eigen::Vector3d at = grid.index_of(p).array().round();
        return grid.offset(static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2]));
    };
    const std::size_t hole = offset_at({-14, -6, 16}), crumb = offset_at({34, 20, 0});
    ASSERT_EQ(abdomen.truth.labels[hole], 1);
    ASSERT_NE(abdomen.truth.labels[crumb], 1);
    abdomen.truth.labels[hole] = 0;
    abdomen.truth.labels[crumb] = 1;
    const LabelMap map = run(&abdomen.volume, &abdomen.truth, {"brain: recipe=brain label=liver"});
    EXPECT_EQ(label_statistics(map)[0].components, 1U);
    EXPECT_EQ(map.labels[hole], 1);
    EXPECT_EQ(map.labels[crumb], 0);
    const LabelMap all =
        run(&abdomen.volume, &abdomen.truth, {"all: recipe=brain label=* keep_largest=no fill_holes=no"});
    EXPECT_EQ(std::ranges::count(all.labels, 0), std::ranges::count(abdomen.truth.labels, 0));
}

TEST(Recipes, structures_grown_from_seeds_share_a_border) {
    const Phantom abdomen = abdomen_phantom({.noise_hu = 10});
    const LabelMap map =
        run(&abdomen.volume, nullptr,
            {"liver: recipe=grow-from-seeds seeds=-14,-6,16", "rest: recipe=grow-from-seeds seeds=34,20,0"});
    EXPECT_GT(dice(map, "liver", abdomen.truth, "liver"), coarse_dice);
    EXPECT_GT(label_statistics(map)[1].volume_ml, 100);
}

TEST(Recipes, structures_grown_from_seeds_run_one_race_whatever_their_tolerances) {
    const Phantom abdomen = abdomen_phantom({.noise_hu = 10});
    const LabelMap map = run(&abdomen.volume, nullptr,
                             {"wide: recipe=grow-from-seeds tolerance=20 seeds=-14,-6,16",
                              "narrow: recipe=grow-from-seeds tolerance=1 seeds=34,20,0"});
    GrowParameters parameters;
    parameters.tolerances = {{"wide", 20}, {"narrow", 1}};
    const std::vector<Seed> seeds{{"wide", {-14, -6, 16}}, {"narrow", {34, 20, 0}}};
    EXPECT_EQ(map.labels, grow_from_seeds(abdomen.volume, seeds, parameters).labels);
    parameters.tolerances["narrow"] = 20;
    EXPECT_NE(map.labels, grow_from_seeds(abdomen.volume, seeds, parameters).labels);
}

TEST(Recipes, structures_that_share_a_file_of_seeds_do_not_compete_with_themselves_as_background) {
    const sample::Scratch scratch;
    const Phantom abdomen = abdomen_phantom({.noise_hu = 10});
    const Eigen::Vector3d in_liver(-14, -6, 16), in_muscle(34, 20, 0), in_air(0, -58, 0);
    write_seeds(scratch / "s.mrk.json",
                std::vector<Seed>{{"Liver", in_liver}, {"Rest", in_muscle}, {"air", in_air}});
    const std::string file = " recipe=grow-from-seeds seeds_file=" + (scratch / "s.mrk.json").string();
    const LabelMap map = run(&abdomen.volume, nullptr, {"liver:" + file, "rest:" + file});
    const std::vector<Seed> seeds{{"liver", in_liver}, {"rest", in_muscle}, {"background", in_air}};
    EXPECT_EQ(map.labels, grow_from_seeds(abdomen.volume, seeds).labels);
}

TEST(Recipes, seeds_come_from_points_and_from_strokes_alike) {
    const sample::Scratch scratch;
    const Phantom abdomen = abdomen_phantom();
    write_seeds(scratch / "points.mrk.json",
                std::vector<Seed>{{"liver", {-14, -6, 16}}, {"other", {34, 20, 0}}});
    LabelMap strokes{abdomen.truth.grid,
                     std::vector<std::uint16_t>(abdomen.truth.labels.size(), 0),
                     {{1, "liver", {}}, {2, "other", {}}}};
    const auto draw = [&](const Eigen::Vector3d& p, std::uint16_t label) {
        const Eigen::Vector3d at = strokes.grid.index_of(p).array().round();
        strokes.labels[strokes.grid.offset(static_cast<int>(at[0]), static_cast<int>(at[1]),
                                           static_cast<int>(at[2]))] = label;
    };
    draw({-14, -6, 16}, 1);
    draw({34, 20, 0}, 2);
    write_label_map(scratch / "strokes.seg.nrrd", strokes);
    const LabelMap points =
        run(&abdomen.volume, nullptr,
            {"liver: recipe=grow-from-seeds seeds_file=" + (scratch / "points.mrk.json").string()});
    const LabelMap drawn =
        run(&abdomen.volume, nullptr,
            {"liver: recipe=grow-from-seeds scribbles=" + (scratch / "strokes.seg.nrrd").string()});
    EXPECT_GT(dice(points, "liver", drawn, "liver"), 0.99);
    EXPECT_GT(dice(points, "liver", abdomen.truth, "liver"), coarse_dice);
}

TEST(Segment, cleaning_steps_follow_the_order_written) {
    const Phantom abdomen = abdomen_phantom();
    // Keeping the largest piece first keeps liver, vessels and all that touches them; opening may then divide
    // it.
    const auto volume = [&](const std::string& steps) {
        return label_statistics(
            run(&abdomen.volume, nullptr, {"x: recipe=threshold lower_hu=80 " + steps}))[0];
    };
    const LabelStatistics first = volume("keep_largest=yes open_mm=4"),
                          last = volume("open_mm=4 keep_largest=yes");
    EXPECT_EQ(last.components, 1U);
    EXPECT_LE(last.voxels, first.voxels);
    EXPECT_NE(volume("open_mm=4 close_mm=8").voxels, volume("close_mm=8 open_mm=4").voxels);
}

TEST(Segment, values_stored_1024_above_hounsfield_are_told_and_treated_alike) {
    Phantom head = head_phantom();
    const LabelMap plain = run(&head.volume, nullptr, {"skull: recipe=bone"});
    for (float& value : head.volume.values) value += 1024;
    std::string said;
    const std::vector<StructureRecipe> bone{parse_structure("skull: recipe=bone")};
    const LabelMap shifted =
        segment(&head.volume, nullptr, bone, {}, [&](std::string_view note) { said += note; });
    EXPECT_EQ(shifted.labels, plain.labels);
    EXPECT_NE(said.find("1024 was subtracted"), std::string::npos);
}

TEST(Segment, values_stored_1000_above_hounsfield_are_told_from_1024_by_their_air) {
    Phantom head = head_phantom({.noise_hu = 5});
    for (const double stored : {1000.0, 1024.0}) {
        Volume volume = head.volume;
        for (float& value : volume.values) value = std::max(0.0F, value + static_cast<float>(stored));
        EXPECT_EQ(hounsfield_offset(volume), stored);
    }
    EXPECT_EQ(hounsfield_offset(head.volume), 0);
    std::string said;
    for (float& value : head.volume.values) value = std::max(0.0F, value + 1000);
    const std::vector<StructureRecipe> bone{parse_structure("skull: recipe=bone")};
    segment(&head.volume, nullptr, bone, {}, [&](std::string_view note) { said += note; });
    EXPECT_NE(said.find("probably stored as HU + 1000"), std::string::npos) << said;
}

TEST(Segment, a_ct_in_eight_bits_is_refused_with_the_scale_that_its_air_and_soft_tissue_tell) {
    Phantom head = head_phantom({.noise_hu = 10});
    const LabelMap plain = run(&head.volume, nullptr, {"skull: recipe=bone"});
    const auto [low, high] = std::ranges::minmax(head.volume.values);
    const double step = (high - low) / 255, lowest = low;
    for (float& value : head.volume.values) value = static_cast<float>(std::round((value - lowest) / step));
    Volume wide = head.volume;
    for (float& value : wide.values) value = std::round(value * 257);  // of 16 bits
    const auto of_wide = scale_by_air_and_soft_tissue(wide);
    const auto found = scale_by_air_and_soft_tissue(head.volume);
    ASSERT_TRUE(found && of_wide);
    EXPECT_NEAR(of_wide->scale, found->scale / 257, 0.01 * step / 257);
    EXPECT_NEAR(of_wide->offset, found->offset, step);
    EXPECT_NEAR(found->scale, step, 0.04 * step);
    const std::string refusal =
        test::refusal_of<Error>([&] { run(&head.volume, nullptr, {"skull: recipe=bone"}); });
    EXPECT_NE(refusal.find("recipe 'bone' looks for HU, and the volume has values of 0 to 255"),
              std::string::npos)
        << refusal;
    EXPECT_NE(refusal.find(fmt::format("scale = {:.4g}", found->scale)), std::string::npos) << refusal;
    rescale(head.volume, {step, lowest});
    EXPECT_TRUE(is_ct(head.volume));
    EXPECT_GT(test::dice(run(&head.volume, nullptr, {"skull: recipe=bone"}), "skull", plain, "skull"), 0.97);
}

TEST(Segment, a_structure_swallowed_by_a_later_one_is_refused_with_both_names) {
    const Phantom abdomen = abdomen_phantom();
    const std::string refusal = test::refusal_of<Error>([&] {
        run(nullptr, &abdomen.truth,
            {"liver: recipe=import", "ball: recipe=sphere inside=liver center_mm=0,0,0 radius_mm=1e4"});
    });
    EXPECT_NE(refusal.find("structure 'ball': takes every voxel of 'liver'"), std::string::npos) << refusal;
}

TEST(Segment, the_livers_volume_is_checked_within_its_region) {
    const Phantom abdomen = abdomen_phantom();
    const LabelMap whole = run(&abdomen.volume, nullptr, {small_liver}),
                   part = run(&abdomen.volume, nullptr,
                              {small_liver + " center_mm=-14,-6,16 radius_mm=10 largest_ml=20"});
    EXPECT_GT(label_statistics(whole)[0].volume_ml, 20);
    EXPECT_LT(label_statistics(part)[0].volume_ml, 5);
}

TEST(Segment, bad_seeds_and_leaks_are_named) {
    const Phantom abdomen = abdomen_phantom();
    const auto refusal = [&](const std::string& text, const std::string& second = "") {
        std::vector<std::string> texts{text};
        if (!second.empty()) texts.push_back(second);
        return test::refusal_of<Error>([&] { run(&abdomen.volume, nullptr, texts); });
    };
    const auto expect = [](const std::string& text, const std::string& phrase) {
        EXPECT_NE(text.find(phrase), std::string::npos) << text;
    };
    expect(refusal("liver: recipe=liver"), "structure 'liver': has no seed");
    for (const std::string recipe : {"liver", "organ"})
        expect(refusal("liver: recipe=" + recipe + " seeds=0,0,0;1,0,0;2,0,0;3,0,0;4,0,0;5,0,0"),
               "structure 'liver': has 6 seeds (expected 1 to 5 points inside it)");
    expect(refusal("liver: recipe=liver seeds=900,0,0"),
           "structure 'liver': seed (900, 0, 0) mm lies outside the volume");
    expect(refusal("liver: recipe=liver seeds=0,-58,0"), "seed (0, -58, 0) mm lies in air");
    expect(refusal("liver: recipe=liver seeds=0,30,0"), "lies in bone");
    expect(refusal("liver: recipe=liver seeds=-14,-6,16 neck_mm=40"),
           "no piece as thick as 80 mm holds a seed");
    expect(refusal("liver: recipe=liver seeds=-14,-6,16 neck_mm=4 largest_ml=20"),
           "it ran into its neighbours");
    expect(refusal("v: recipe=vessels"), "has neither 'inside' nor a seed");
    expect(refusal("g: recipe=grow-from-seeds"), "structure 'g': has no seed");
    expect(refusal(small_liver, "t: recipe=tumour inside=liver seeds=40,20,0"),
           "seed (40, 20, 0) mm is not there");
    expect(refusal(small_liver, "t: recipe=tumour inside=liver seeds=-8,-6,16"),
           "1.5 deviations and 5 HU or more");
    expect(refusal(small_liver, "t: recipe=tumour inside=liver"), "structure 't': has no seed");
}

TEST(Segment, later_structures_take_background_only_and_values_follow_the_order) {
    const Phantom head = head_phantom();
    const LabelMap map =
        run(&head.volume, nullptr,
            {"skull: recipe=bone", "tissue: recipe=threshold lower_hu=-200 keep_largest=yes"});
    const LabelMap skull = run(&head.volume, nullptr, {"skull: recipe=bone"});
    for (std::size_t i = 0; i < map.labels.size(); ++i) EXPECT_EQ(map.labels[i] == 1, skull.labels[i] == 1);
    ASSERT_EQ(map.names.size(), 2U);
    EXPECT_EQ(map.names[1].name, "tissue");
    EXPECT_EQ(map.names[1].value, 2);
}

TEST(Segment, reports_each_structure_before_it_is_made) {
    const Phantom abdomen = abdomen_phantom();
    const std::vector<StructureRecipe> structures{parse_structure("liver: recipe=import"),
                                                  parse_structure("ribs: recipe=import")};
    std::string said;
    segment(nullptr, &abdomen.truth, structures,
            [&](std::string_view name, double fraction) { said += fmt::format("{} {}; ", name, fraction); });
    EXPECT_EQ(said, "liver 0; ribs 0.5; ");
}

TEST(Segment, refusals_name_the_structure_and_what_to_change) {
    const Phantom head = head_phantom();
    const auto refusal = [&](const std::vector<std::string>& texts) {
        return test::refusal_of<Error>([&] { run(&head.volume, &head.truth, texts); });
    };
    EXPECT_EQ(refusal({"skull: recipe=bone threshold_hu=3000"}),
              "structure 'skull': is empty; lower threshold_hu or min_component_ml; are the values in HU?");
    EXPECT_EQ(refusal({"x: recipe=import label=skul"}),
              "structure 'x': no label 'skul'; nearest names: 'skull', 'wall', 'airway'");
    EXPECT_NE(refusal({"w: recipe=nasopharynx"}).find("no label 'airway'"), std::string::npos);
    EXPECT_NE(refusal({"skull: recipe=import", "t: recipe=sphere center_mm=0,0,0 radius_mm=2"})
                  .find("has no 'inside'"),
              std::string::npos);
    EXPECT_NE(refusal({"a: recipe=airway seeds_mm=0,4,14"}).find("seed (0, 4, 14) mm"), std::string::npos);
    EXPECT_NE(refusal({"a: recipe=bone", "a: recipe=airway"}).find("occurs twice"), std::string::npos);
    EXPECT_NE(refusal({"a: recipe=bone radius_mm=3"}).find("has no 'center_mm'"), std::string::npos);
    EXPECT_NE(
        test::refusal_of<Error>([&] { run(nullptr, &head.truth, {"skull: recipe=bone"}); }).find("no volume"),
        std::string::npos);
    EXPECT_NE(test::refusal_of<Error>([&] {
                  run(&head.volume, nullptr, {"skull: recipe=import"});
              }).find("no label map"),
              std::string::npos);
    EXPECT_THROW(run(nullptr, nullptr, {"skull: recipe=bone"}), InvalidInput);
    EXPECT_THROW(run(&head.volume, nullptr, {}), InvalidInput);
}

TEST(RecipeParameters, unknown_names_and_wrong_kinds_are_refused_with_the_nearest_name) {
    EXPECT_NE(test::refusal_of<Error>([] {
                  parse_structure("s: recipe=bone treshold_hu=3");
              }).find("recipe 'bone' has no parameter 'treshold_hu'; nearest names: 'threshold_hu'"),
              std::string::npos);
    EXPECT_NE(
        test::refusal_of<Error>([] { parse_structure("s: recipe=bones"); }).find("nearest names: 'bone'"),
        std::string::npos);
    EXPECT_THROW(parse_structure("s: recipe=bone threshold_hu=high"), InvalidInput);
    EXPECT_THROW(parse_structure("s: recipe=bone open_mm=-1"), InvalidInput);
    EXPECT_THROW(parse_structure("s: recipe=bone keep_largest=perhaps"), InvalidInput);
    EXPECT_THROW(parse_structure("s: recipe=bone center_mm=1,2 radius_mm=3"), InvalidInput);
    EXPECT_THROW(check_recipe({"s", "bone", {{"threshold_hu", std::string("226")}}}), InvalidInput);
    for (const char* text : {"", "bone", ": recipe=bone", "s: threshold_hu=3", "s: recipe=bone fast",
                             "s: recipe=bone open_mm=1 open_mm=2"})
        EXPECT_THROW(parse_structure(text), UsageError) << text;
}

TEST(RecipeParameters, numbers_that_cannot_be_meant_are_refused) {
    for (const char* text :
         {"s: recipe=bone threshold_hu=nan", "s: recipe=bone threshold_hu=inf", "s: recipe=bone open_mm=inf",
          "s: recipe=threshold lower_hu=nan", "s: recipe=liver seeds=1,nan,2",
          "s: recipe=liver seeds=1,inf,2", "s: recipe=liver tolerance_hu=0", "s: recipe=liver drift_hu=-1",
          "s: recipe=liver largest_ml=-1", "s: recipe=vessels contrast_hu=-1",
          "s: recipe=grow-from-seeds tolerance=0", "s: recipe=grow-from-seeds tolerance=-3",
          "s: recipe=sphere radius_mm=-1", "s: recipe=bone box_min_mm=-inf,0,0 box_max_mm=1,1,1"})
        EXPECT_THROW(parse_structure(text), InvalidInput) << text;
    EXPECT_NO_THROW(parse_structure("s: recipe=threshold lower_hu=-inf upper_hu=inf"));
    EXPECT_THROW(parse_structure("a\xff: recipe=bone"), UsageError);
    EXPECT_NO_THROW(parse_structure("m\xc3\xa9ninge: recipe=bone"));
}

TEST(RecipeParameters, keep_to_the_range_that_their_recipe_states) {
    using Range = RecipeParameter::Range;
    for (const Recipe& recipe : recipes())
        for (const RecipeParameter& parameter : recipe.parameters) {
            if (parameter.kind != RecipeParameter::Kind::number) continue;
            const std::string text = "s: recipe=" + recipe.name + " " + parameter.name + "=";
            const auto refusal = [&](const std::string& value) {
                return test::refusal_of<Error>([&] { parse_structure(text + value); });
            };
            EXPECT_SAYS(refusal("nan"), "expected a number");
            EXPECT_EQ(refusal("inf") == "nothing was refused", parameter.range == Range::any) << text;
            const bool negative = parameter.range == Range::any || parameter.range == Range::finite;
            EXPECT_EQ(refusal("-1") == "nothing was refused", negative) << text;
            if (!negative) {
                EXPECT_SAYS(refusal("-1"), "expected " + range_text(parameter.range));
            }
            EXPECT_EQ(refusal("0") == "nothing was refused", parameter.range != Range::positive) << text;
        }
}

TEST(RecipeParameters, defaults_are_values_that_a_person_could_write) {
    for (const Recipe& recipe : recipes())
        for (const RecipeParameter& parameter : recipe.parameters) {
            EXPECT_FALSE(parameter.meaning.empty()) << recipe.name << " " << parameter.name;
            EXPECT_EQ(find_parameter(recipe, parameter.name), &parameter) << "one of two of that name";
            if (parameter.default_value.empty()) continue;
            const std::string text =
                "s: recipe=" + recipe.name + " " + parameter.name + "=" + parameter.default_value;
            EXPECT_NO_THROW(parse_structure(text)) << text;
        }
}

TEST(RecipeTable, lists_each_recipe_once_by_name_with_what_it_makes_and_what_to_change) {
    ASSERT_FALSE(recipes().empty());
    for (std::size_t n = 0; n < recipes().size(); ++n) {
        const Recipe& recipe = recipes()[n];
        if (n > 0) {
            EXPECT_LT(recipes()[n - 1].name, recipe.name);
        }
        EXPECT_EQ(find_recipe(recipe.name), &recipe);
        EXPECT_FALSE(recipe.meaning.empty() || recipe.if_empty.empty()) << recipe.name;
        EXPECT_NE(recipe.make, nullptr) << recipe.name;
    }
    EXPECT_EQ(find_recipe("boen"), nullptr);
}

TEST(RecipeParameters, are_read_by_kind) {
    const StructureRecipe structure =
        parse_structure("a: recipe=airway seeds_mm=1,2,3;4,5,6 fill_holes=yes threshold_hu=-5e2");
    EXPECT_EQ(std::get<std::vector<double>>(structure.parameters.at("seeds_mm")),
              (std::vector<double>{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(std::get<bool>(structure.parameters.at("fill_holes")), true);
    EXPECT_EQ(std::get<double>(structure.parameters.at("threshold_hu")), -500);
}

TEST(LabelNames, rename_listed_values_and_drop_the_rest) {
    LabelMap map = abdomen_phantom().truth;
    rename_labels(map, parse_label_names("2=lesion,1=organ"));
    ASSERT_EQ(map.names.size(), 2U);
    EXPECT_EQ(map.names[0].name, "organ");
    EXPECT_EQ(std::ranges::max(map.labels), 2);
    EXPECT_THROW(rename_labels(map, parse_label_names("9=x")), InvalidInput);
    for (const char* text : {"liver", "=liver", "1=", "1=a,1=b", "1=a,2=a", "0=a", "1x=a"})
        EXPECT_THROW(parse_label_names(text), UsageError) << text;
}

TEST(Phantom, refuses_options_that_make_no_image) {
    EXPECT_THROW(head_phantom({.spacing = {1, 0, 1}}), InvalidInput);
    EXPECT_THROW(head_phantom({.samples_per_axis = 0}), InvalidInput);
    EXPECT_THROW(abdomen_phantom({.noise_hu = -1}), InvalidInput);
}

TEST(Phantom, the_tumour_is_enclosed_by_the_liver) {
    const LabelMap truth = abdomen_phantom().truth;
    const auto& grid = truth.grid;
    for (std::int32_t k = 1; k + 1 < grid.size[2]; ++k)
        for (std::int32_t j = 1; j + 1 < grid.size[1]; ++j)
            for (std::int32_t i = 1; i + 1 < grid.size[0]; ++i)
                if (truth.labels[grid.offset(i, j, k)] == 2) {
                    for (const std::size_t neighbour :
                         {grid.offset(i - 1, j, k), grid.offset(i + 1, j, k), grid.offset(i, j - 1, k),
                          grid.offset(i, j + 1, k), grid.offset(i, j, k - 1), grid.offset(i, j, k + 1)})
                        EXPECT_TRUE(truth.labels[neighbour] == 1 || truth.labels[neighbour] == 2);
                }
}

}  // namespace
}  // namespace palpate
