// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/tools/imaging/hand_written_images.hpp"
#include "tests/tools/real_data.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/files/label_names.hpp"
#include "tools/imaging/recipes/segmentation.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"
#include "tools/imaging/voxels/label_statistics.hpp"

namespace palpate {
namespace {

using namespace imaging;

double mean_within(const Volume& volume, const LabelMap& labels, std::int32_t value) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < labels.labels.size(); ++i)
        if (labels.labels[i] == value) {
            sum += volume.values[i];
            ++count;
        }
    return sum / count;
}

TEST(RealImages, a_nifti_ct_and_its_labels_lie_on_one_grid_with_the_liver_on_the_right) {
    REQUIRE_REAL_DATA(folder, "abdomen_ct_totalseg3mm");
    const Volume ct = read_volume(folder / "ct.nii.gz");
    const LabelMap labels = read_label_map(folder / "seg_totalseg.nii.gz");
    ASSERT_TRUE(same_grid(ct.grid, labels.grid));
    // TotalSegmentator wrote the names into the file.
    const Label liver = require_label(labels, "liver", "labels"),
                spleen = require_label(labels, "spleen", "labels");
    // Liver without contrast: 40 to 70 HU.
    EXPECT_NEAR(mean_within(ct, labels, liver.value), 55, 15);
    std::map<std::int32_t, Eigen::Vector3d> centroids;
    for (const LabelStatistics& label : label_statistics(labels))
        centroids[label.label.value] = label.centroid;
    EXPECT_LT(centroids[liver.value][0], centroids[spleen.value][0]);  // x grows to the left
}

// As programs write a CT in 8 bits: what lies between two values, evenly, and what lies beyond at the ends.
Volume in_eight_bits(Volume volume, double black_hu, double white_hu) {
    for (float& value : volume.values)
        value = static_cast<float>(
            std::round(std::clamp((value - black_hu) / (white_hu - black_hu), 0.0, 1.0) * 255));
    return volume;
}

TEST(RealImages, a_ct_in_eight_bits_tells_its_scale_by_air_and_soft_tissue) {
    REQUIRE_REAL_DATA(folder, "head_ct_cranium");
    const Volume ct = read_volume(folder / "head_ct_cranium.nrrd");
    for (const auto& [black, white] : {std::pair(-1024.0, 2986.0), {-1024.0, 3071.0}, {-1000.0, 2000.0}}) {
        const auto found = scale_by_air_and_soft_tissue(in_eight_bits(ct, black, white));
        ASSERT_TRUE(found) << black << " to " << white;
        const double step = (white - black) / 255;
        EXPECT_NEAR(found->scale, step, 0.04 * step);
        EXPECT_NEAR(found->scale * 80 + found->offset, 80 * step + black, 40) << "HU";
    }
    EXPECT_FALSE(scale_by_air_and_soft_tissue(in_eight_bits(ct, -160, 240))) << "air is cut off";
    EXPECT_FALSE(scale_by_air_and_soft_tissue(in_eight_bits(ct, -500, 1500))) << "air is cut off";
}

TEST(RealImages, an_mri_is_taken_for_no_ct) {
    REQUIRE_REAL_DATA(folder, "head_mr_ch2");
    EXPECT_FALSE(scale_by_air_and_soft_tissue(read_volume(folder / "ch2.nii.gz")));
}

TEST(RealImages, totalsegmentators_names_in_its_files_are_those_of_its_table) {
    REQUIRE_REAL_DATA(folder, "abdomen_ct_totalseg3mm");
    const LabelMap labels = read_label_map(folder / "seg_totalseg.nii.gz");
    const LabelTable table = totalsegmentator_table("v2/total");
    EXPECT_GT(labels.names.size(), 40U);
    for (const Label& label : labels.names) EXPECT_EQ(label.name, table.at(label.value).name);
}

TEST(RealImages, an_atlas_takes_its_names_and_colours_from_a_slicer_table) {
    REQUIRE_REAL_DATA(folder, "abdomen_ct_spl");
    LabelMap labels = read_label_map(folder / "seg.nrrd");
    name_labels(labels, folder / "labels_spl.ctbl");
    const Label liver = require_label(labels, "Liver", "labels");
    EXPECT_EQ(liver.value, 3);
    EXPECT_EQ(liver.colour, (std::array<float, 3>{147 / 255.0F, 59 / 255.0F, 0}));
    EXPECT_EQ(require_label(labels, "right kidney", "labels").value, 51);
}

TEST(RealImages, a_detached_big_endian_nrrd_is_smooth) {
    REQUIRE_REAL_DATA(folder, "tooth_ct_seg3d");
    const Volume tooth = read_volume(folder / "tooth.nhdr");
    EXPECT_EQ(tooth.grid.size, (std::array<std::int32_t, 3>{103, 94, 161}));
    double step = 0, count = 0;
    for (int k = 0; k < 161; ++k)
        for (int i = 1; i < 103; ++i, ++count)
            step += std::abs(tooth.values[tooth.grid.offset(i, 47, k)] -
                             tooth.values[tooth.grid.offset(i - 1, 47, k)]);
    EXPECT_LT(step / count, 60) << "of a range of 1300; swapped bytes would be noise";
}

TEST(RealImages, a_dicom_series_without_identifiers_fits_its_nifti_labels) {
    REQUIRE_REAL_DATA(folder, "abdomen_dicom_ts20");
    const Volume ct = read_volume(folder / "dicom");
    EXPECT_EQ(ct.grid.size, (std::array<std::int32_t, 3>{512, 512, 20}));
    EXPECT_DOUBLE_EQ(ct.grid.spacing[2], 2);
    const LabelMap labels = read_label_map(folder / "seg_totalseg.nii.gz");
    const std::vector<StructureRecipe> structures{parse_structure("liver: recipe=import label=5")};
    const LabelMap on_ct = segment(&ct, &labels, structures);
    // Liver with contrast: 80 to 140 HU; a flipped axis would mix in lung or fat.
    EXPECT_NEAR(mean_within(ct, on_ct, 1), 110, 30);
}

TEST(RealImages, dicom_segmentations_beside_a_series_are_skipped_and_lie_on_its_grid) {
    REQUIRE_REAL_DATA(folder, "abdomen_dicom_seg_dcmqi");
    std::string notes;
    const Volume ct = read_volume(folder, [&](std::string_view note) { notes += note; });
    EXPECT_EQ(ct.grid.size[2], 3);
    EXPECT_NE(notes.find("2 DICOM files that are no images: SEG"), std::string::npos);
    const LabelMap twin = read_label_map(folder / "liver_seg.nrrd"),
                   liver = read_label_map(folder / "liver.dcm");
    EXPECT_TRUE(same_grid(ct.grid, twin.grid));
    EXPECT_TRUE(same_grid(ct.grid, liver.grid));
    ASSERT_EQ(liver.names.size(), 1U);
    EXPECT_EQ(liver.names[0].name, "Liver");
    EXPECT_EQ(liver.labels, twin.labels);
}

TEST(RealImages, overlapping_segments_of_a_dicom_segmentation_are_those_of_its_nrrd_twins) {
    REQUIRE_REAL_DATA(folder, "abdomen_dicom_seg_dcmqi");
    const auto file = folder / "partial_overlaps.dcm";
    try {
        read_label_map(file);
        FAIL() << "was read";
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("'GREEN' and 'ORANGE' both claim"), std::string::npos)
            << error.what();
    }
    // The twins hold the segments by number, overlapping ones in different files.
    ReadOptions later;
    later.overlaps = Overlaps::later_wins;
    const LabelMap map = read_label_map(file, {}, later);
    ASSERT_EQ(map.names.size(), 5U);
    EXPECT_EQ(map.names[3].name, "LIGHT_BLUE");
    EXPECT_GT(map.names[3].colour[2], map.names[3].colour[0]);
    std::vector<std::uint16_t> expected(map.labels.size(), 0);
    for (int i = 1; i <= 3; ++i) {
        const LabelMap twin = read_label_map(folder / fmt::format("partial_overlaps-{}.nrrd", i));
        ASSERT_TRUE(same_grid(twin.grid, map.grid));
        for (std::size_t n = 0; n < expected.size(); ++n) expected[n] = std::max(expected[n], twin.labels[n]);
    }
    EXPECT_EQ(map.labels, expected);
}

TEST(RealImages, a_missing_dicom_slice_is_refused_with_its_place) {
    REQUIRE_REAL_DATA(folder, "abdomen_dicom_ts20");
    const sample::Scratch copy;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "dicom"))
        files.push_back(entry.path());
    std::ranges::sort(files);
    for (std::size_t i = 0; i < files.size(); ++i)
        if (i != 7) std::filesystem::copy_file(files[i], copy / files[i].filename());
    try {
        read_volume(copy.path());
        FAIL() << "was read";
    } catch (const InvalidInput& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("4.000 mm between the slices at"), std::string::npos) << message;
        EXPECT_NE(message.find("expected 2.000 mm"), std::string::npos) << message;
    }
    std::filesystem::copy_file(files[0], copy / "again.dcm");
    EXPECT_THROW(read_volume(copy.path()), InvalidInput);
}

TEST(RealImages, bone_of_a_head_is_the_threshold_without_head_rest_and_table) {
    REQUIRE_REAL_DATA(folder, "head_ct_cranium");
    const Volume ct = read_volume(folder / "head_ct_cranium.nrrd");
    const LabelMap all = read_label_map(folder / "head_ct_cranium_mask_bone.nrrd");
    const std::vector<StructureRecipe> structures{parse_structure("skull: recipe=bone")};
    const LabelMap map = segment(&ct, nullptr, structures);
    std::size_t bone = 0, in_mask = 0;
    for (std::size_t i = 0; i < map.labels.size(); ++i) {
        bone += map.labels[i];
        in_mask += map.labels[i] && all.labels[i];
    }
    EXPECT_EQ(bone, in_mask);
    const LabelStatistics skull = label_statistics(map)[0];
    // An adult's cranium with upper jaw and first vertebra: about 0.4 to 0.8 l at this threshold.
    EXPECT_GT(skull.volume_ml, 400);
    EXPECT_LT(skull.volume_ml, 800);
    // The head rest's shell is up to 240 mm wide, the head below 160.
    EXPECT_LT(skull.box.sizes()[0], 160);
}

TEST(RealImages, the_wall_of_the_nasopharynx_is_one_piece_around_the_air_below_the_skull_base) {
    REQUIRE_REAL_DATA(folder, "head_ct_cranium");
    const Volume ct = read_volume(folder / "head_ct_cranium.nrrd");
    const std::vector<StructureRecipe> structures{
        parse_structure("skull: recipe=bone"), parse_structure("airway: recipe=airway seeds_mm=125,-142,19"),
        parse_structure("wall: recipe=nasopharynx center_mm=126,-136,16 radius_mm=26 thickness_mm=8"),
        parse_structure("tumour: recipe=sphere inside=wall center_mm=110,-133,22 radius_mm=5.5")};
    const LabelMap map = segment(&ct, nullptr, structures);
    const auto statistics = label_statistics(map);
    const LabelStatistics &skull = statistics[0], &airway = statistics[1], &wall = statistics[2],
                          &tumour = statistics[3];
    EXPECT_EQ(airway.components, 1U);
    EXPECT_EQ(wall.components, 1U);
    EXPECT_EQ(tumour.components, 1U);
    EXPECT_NEAR(mean_within(ct, map, 3), 20, 60);  // muscle and mucosa, some fat
    // The nose lies before the skull, the wall before its vertebra and below its base: y to posterior, z up.
    EXPECT_LT(airway.box.min()[1], skull.box.min()[1] + 10);
    EXPECT_LT(wall.centroid[1], skull.centroid[1]);
    EXPECT_LT(wall.box.max()[2], 45);
    EXPECT_GT(tumour.volume_ml, 0.5 * 4.0 / 3 * M_PI * std::pow(5.5, 3) / 1000);
}

}  // namespace
}  // namespace palpate
