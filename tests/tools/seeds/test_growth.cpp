// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "sample_data/phantoms.hpp"
#include "tools/imaging/voxels/grow_from_seeds.hpp"
#include "tools/seeds/growth.hpp"
#include "tools/seeds/slice_picture.hpp"

namespace palpate {
namespace {

using namespace imaging;
using namespace seeds;

const Seed in_liver{"liver", {10, 0, 0}};

TEST(GrowthWorker, gives_the_growth_of_the_last_request) {
    const Phantom phantom = abdomen_phantom();
    GrowthWorker worker(preview_growing(phantom.volume));
    EXPECT_FALSE(worker.busy());
    worker.request({{"spine", {0, 40, 0}}});
    worker.request({in_liver});
    EXPECT_TRUE(worker.busy());
    worker.wait();
    const auto growth = worker.take();
    ASSERT_TRUE(growth);
    EXPECT_FALSE(worker.busy());
    EXPECT_FALSE(worker.take());
    ASSERT_EQ(growth->map.names.size(), 1U);
    EXPECT_EQ(growth->map.names[0].name, "liver");
    EXPECT_EQ(growth->map.labels,
              grow_from_seeds(phantom.volume, std::vector{in_liver}, preview_parameters(phantom.volume.grid))
                  .labels);
    const auto voxels = std::ranges::count(growth->map.labels, 1);
    EXPECT_GT(voxels, 1000);
    EXPECT_NEAR(growth->volume_ml[0], static_cast<double>(voxels) * 8 / 1000, 1e-9);  // voxels of 8 mm³
}

TEST(GrowthWorker, of_no_seeds_is_empty) {
    const Phantom phantom = abdomen_phantom();
    GrowthWorker worker(preview_growing(phantom.volume));
    worker.request({});
    worker.wait();
    const auto growth = worker.take();
    ASSERT_TRUE(growth);
    EXPECT_TRUE(growth->map.labels.empty());
}

TEST(GrowthWorker, tells_why_nothing_could_be_made_and_goes_on) {
    const Phantom phantom = abdomen_phantom();
    GrowthWorker worker(preview_growing(phantom.volume));
    worker.request({{"liver", {1000, 0, 0}}});
    worker.wait();
    const auto refused = worker.take();
    ASSERT_TRUE(refused);
    EXPECT_NE(refused->refused.find("liver"), std::string::npos) << refused->refused;
    EXPECT_TRUE(refused->map.labels.empty());
    worker.request({in_liver});
    worker.wait();
    EXPECT_TRUE(worker.take());
}

TEST(GrowthWorker, hands_on_what_is_no_fault_of_the_seeds) {
    GrowthWorker worker({[](std::span<const Seed>) -> LabelMap {
        throw SystemFailure({"memory", "", "", ""});
    }});
    worker.request({in_liver});
    worker.wait();
    EXPECT_THROW(worker.take(), SystemFailure);
}

TEST(RecipeGrowing, makes_what_the_command_makes_of_the_same_seeds) {
    const Phantom phantom = abdomen_phantom();
    const Growing growing =
        recipe_growing(phantom.volume, {parse_structure("bones: recipe=bone"),
                                        parse_structure("liver: recipe=grow-from-seeds open_mm=2"),
                                        parse_structure("spine: recipe=grow-from-seeds")});
    const LabelMap shown = growing.labels_of(std::vector<Seed>{in_liver, {"background", {-20, 30, 0}}});
    const LabelMap made = segment(
        &phantom.volume, nullptr,
        std::vector{
            parse_structure("bones: recipe=bone"),
            parse_structure("liver: recipe=grow-from-seeds seeds=10,0,0 background_mm=-20,30,0 open_mm=2")});
    EXPECT_EQ(shown.labels, made.labels) << "without the spine, which has no seed";
    EXPECT_EQ(shown.names.size(), 2U);
    const auto folder = std::filesystem::temp_directory_path() / "palpate_recipe_growing";
    std::filesystem::create_directories(folder);
    const std::vector<Seed> seeds{{"Liver", {10, 0, 0}}, {"kidney", {-20, 30, 0}}};
    write_seeds(folder / "two.mrk.json", seeds);
    const std::string liver = "liver: recipe=grow-from-seeds open_mm=2";
    EXPECT_EQ(
        recipe_growing(phantom.volume, {parse_structure(liver)}).labels_of(seeds).labels,
        segment(&phantom.volume, nullptr,
                std::vector{parse_structure(liver + " seeds_file=" + (folder / "two.mrk.json").string())})
            .labels)
        << "names ignore case, and others compete";
    std::filesystem::remove_all(folder);
    const LabelMap without =
        recipe_growing(phantom.volume, {parse_structure("liver: recipe=grow-from-seeds")})
            .labels_of(std::vector<Seed>{{"background", {-20, 30, 0}}});
    EXPECT_TRUE(without.labels.empty());
}

TEST(SlicePicture, tints_what_has_grown_and_leaves_the_rest_grey) {
    const Phantom phantom = abdomen_phantom();
    GrowthWorker worker(preview_growing(phantom.volume));
    worker.request({in_liver});
    worker.wait();
    const auto growth = worker.take();
    const ImageGrid& grid = phantom.volume.grid;
    const SliceView axial = slice_views(grid)[0];
    const std::vector<std::string> labels{"background", "liver"};
    const auto picture = slice_picture(phantom.volume, axial, 32, {"", 400, 40}, growth.get(), labels);
    ASSERT_EQ(picture.rgb.size(), 3U * 64 * 64);
    EXPECT_TRUE(picture.cover[0].empty());
    ASSERT_EQ(picture.cover[1].size(), 64U * 64);
    std::size_t tinted = 0, wrong = 0;
    for (std::size_t pixel = 0; pixel < 64 * 64; ++pixel) {
        const bool coloured = picture.rgb[3 * pixel] != picture.rgb[3 * pixel + 2];
        const float cover = picture.cover[1][pixel];
        tinted += coloured ? 1 : 0;
        wrong += (cover == 0 && coloured) || (cover > 0.7F && !coloured) ? 1 : 0;
    }
    EXPECT_EQ(wrong, 0U);
    EXPECT_GT(tinted, 100U);
    EXPECT_LT(tinted, 64U * 64 / 2);
}

TEST(GreyScale, offers_ct_windows_for_a_ct_and_percentiles_for_the_rest) {
    Volume volume = abdomen_phantom().volume;
    EXPECT_TRUE(grey_scale(volume).hounsfield);
    EXPECT_EQ(grey_scale(volume).presets.front().level, 40);
    EXPECT_EQ(grey_scale(volume).presets.front().shade(40), 0.5);
    EXPECT_EQ(grey_scale(volume).presets.front().shade(-161), 0);
    for (std::size_t i = 0; i < volume.values.size(); ++i) volume.values[i] = static_cast<float>(i % 101);
    const GreyScale other = grey_scale(volume);
    EXPECT_FALSE(other.hounsfield);
    EXPECT_NEAR(other.presets.front().level, 50, 1);
    EXPECT_NEAR(other.presets.front().width, 98, 1);
}

}  // namespace
}  // namespace palpate
