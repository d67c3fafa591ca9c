// SPDX-License-Identifier: GPL-3.0-or-later
// The recipes against reference labels of real volumes. Seeds are drawn at random inside the reference, so
// that nothing depends on chosen points.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <random>

#include "tests/tools/imaging/run_recipes.hpp"
#include "tests/tools/real_data.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/recipes/segmentation.hpp"
#include "tools/imaging/voxels/label_statistics.hpp"
#include "tools/imaging/voxels/mask.hpp"

namespace palpate {
namespace {

using namespace imaging;
using namespace test;

// "x,y,z;x,y,z;...": five points at least 8 mm inside.
std::string random_seeds(const Mask& reference, unsigned seed) {
    const Mask inside = erode(reference, 8);
    std::mt19937 random(seed);
    std::string text;
    for (int n = 0; n < 5;) {
        const auto index = [&](std::size_t axis) {
            return static_cast<std::int32_t>(random() % static_cast<unsigned>(inside.grid.size[axis]));
        };
        const std::int32_t i = index(0), j = index(1), k = index(2);
        if (!inside.voxels[inside.grid.offset(i, j, k)]) continue;
        const Eigen::Vector3d p = inside.grid.point_of(Eigen::Vector3d(i, j, k));
        text += fmt::format("{}{:.1f},{:.1f},{:.1f}", n++ > 0 ? ";" : "", p[0], p[1], p[2]);
    }
    return text;
}

void expect_liver(const Volume& volume, const Mask& reference, double least) {
    for (const unsigned seed : {1U, 2U}) {
        const std::string seeds = random_seeds(reference, seed);
        const LabelMap map = run(&volume, nullptr, {"liver: recipe=liver seeds=" + seeds});
        EXPECT_GE(dice(mask_of(map, "liver"), reference), least) << seeds;
        EXPECT_EQ(label_statistics(map)[0].components, 1U);
    }
}

// Each a little below the worst of the draws in tests/benchmarks/README.md, table of Segmentation.
constexpr double atlas_dice = 0.925;
constexpr double slab_dice = 0.965;
constexpr double plain_dice = 0.94;

TEST(RealSegmentation, liver_with_contrast_from_five_seeds) {
    REQUIRE_REAL_DATA(folder, "abdomen_ct_spl");
    expect_liver(read_volume(folder / "ct.nrrd"), mask_of(read_label_map(folder / "seg.nrrd"), "3"),
                 atlas_dice);
}

TEST(RealSegmentation, liver_in_a_slab_with_streaks_from_five_seeds) {
    REQUIRE_REAL_DATA(folder, "abdomen_dicom_ts20");
    const Volume volume = read_volume(folder / "dicom");
    const LabelMap prior = read_label_map(folder / "seg_totalseg.nii.gz");
    const LabelMap reference = run(&volume, &prior, {"liver: recipe=import label=5"});
    expect_liver(volume, mask_of(reference, "liver"), slab_dice);
}

TEST(RealSegmentation, liver_without_contrast_from_five_seeds) {
    REQUIRE_REAL_DATA(folder, "abdomen_ct_totalseg3mm");
    expect_liver(read_volume(folder / "ct.nii.gz"),
                 mask_of(read_label_map(folder / "seg_totalseg.nii.gz"), "5"), plain_dice);
}

// Of the scan above, which has 16 HU within the liver: what noise makes there is as steep as its border to
// muscle then, and with the usual smoothing alone the overlap is 0.91.
constexpr double added_noise_hu = 10, noisy_dice = 0.925;

TEST(RealSegmentation, liver_without_contrast_in_more_noise_from_one_seed) {
    REQUIRE_REAL_DATA(folder, "abdomen_ct_totalseg3mm");
    Volume volume = read_volume(folder / "ct.nii.gz");
    std::mt19937 random(1);
    std::normal_distribution<float> noise(0, added_noise_hu);
    for (float& value : volume.values) value += noise(random);
    const LabelMap map = run(&volume, nullptr, {"liver: recipe=liver seeds=-80,-152,390"});
    EXPECT_GE(dice(mask_of(map, "liver"), mask_of(read_label_map(folder / "seg_totalseg.nii.gz"), "5")),
              noisy_dice);
}

TEST(RealSegmentation, bone_of_a_head_is_the_threshold_mask_without_its_head_rest) {
    REQUIRE_REAL_DATA(folder, "head_ct_cranium");
    const Volume volume = read_volume(folder / "head_ct_cranium.nrrd");
    const LabelMap thresholded = read_label_map(folder / "head_ct_cranium_mask_bone.nrrd");
    const Mask reference =
        mask_of(run(nullptr, &thresholded, {"bone: recipe=import label=* keep_largest=yes"}), "bone");
    EXPECT_GE(dice(mask_of(run(&volume, nullptr, {"bone: recipe=bone"}), "bone"), reference), 0.95);
    EXPECT_GE(dice(mask_of(run(&volume, nullptr, {"bone: recipe=bone threshold_hu=0"}), "bone"), reference),
              0.95);
}

TEST(RealSegmentation, airway_of_a_head_is_one_passage_from_nose_to_larynx) {
    REQUIRE_REAL_DATA(file, "head_ct_headsq64/head_ct_headsq64.mhd");
    const Volume volume = read_volume(file);
    const LabelMap map = run(&volume, nullptr, {"airway: recipe=airway"});
    const LabelStatistics airway = label_statistics(map)[0];
    EXPECT_EQ(airway.components, 1U);
    // The nostrils lie near y = 170 mm, the last slice at z = 138 mm is in the larynx.
    EXPECT_GT(airway.box.max()[1], 165);
    EXPECT_DOUBLE_EQ(airway.box.max()[2], 138);
    EXPECT_LT(airway.box.min()[2], 30);
}

}  // namespace
}  // namespace palpate
