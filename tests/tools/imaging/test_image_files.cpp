// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <gtest/gtest.h>
#include <numeric>
#include <sys/resource.h>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/tools/imaging/hand_written_images.hpp"
#include "tests/tools/imaging/refusals.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/files/label_names.hpp"

namespace palpate {
namespace {

using namespace imaging;
using sample::Scratch;
using test::expect_same_place;
using test::header_tolerance;
using test::refusal_of;
using test::write_bytes;

Volume ramp_volume() {
    Volume volume;
    volume.grid.size = {4, 5, 6};
    volume.grid.spacing = {0.5, 0.75, 1.25};
    volume.grid.origin = {-10.5, 20.25, 30.125};
    volume.values.resize(volume.grid.voxel_count());
    std::iota(volume.values.begin(), volume.values.end(), -7.0F);
    return volume;
}

Eigen::Matrix3d oblique() {
    return (Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitX()) *
            Eigen::AngleAxisd(-0.6, Eigen::Vector3d(1, 2, 3).normalized()))
        .toRotationMatrix();
}

// The 48 signed permutations of the axes, and an oblique rotation of each handedness.
std::vector<Eigen::Matrix3d> all_directions() {
    std::vector<Eigen::Matrix3d> directions{oblique(), -oblique()};
    std::array<int, 3> order{0, 1, 2};
    do {
        for (unsigned signs = 0; signs < 8; ++signs) {
            Eigen::Matrix3d direction = Eigen::Matrix3d::Zero();
            for (int axis = 0; axis < 3; ++axis)
                direction(order[static_cast<std::size_t>(axis)], axis) = (signs >> axis & 1U) ? -1 : 1;
            directions.push_back(direction);
        }
    } while (std::ranges::next_permutation(order).found);
    return directions;
}

std::string float_bytes(const Volume& volume) {
    return test::raw_bytes<float>(volume.values);
}

TEST(ImageFiles, every_axis_order_and_obliquity_of_every_format_reads_as_the_same_place) {
    const Scratch folder;
    Volume volume = ramp_volume();
    for (const Eigen::Matrix3d& direction : all_directions()) {
        volume.grid.direction = direction;
        const std::string voxels = float_bytes(volume);
        write_bytes(folder / "lps.nrrd",
                    test::nrrd_file(volume.grid, "float", voxels, "left-posterior-superior"));
        write_bytes(folder / "ras.nrrd",
                    test::nrrd_file(volume.grid, "float", voxels, "right-anterior-superior"));
        write_bytes(folder / "v.mha", test::meta_file(volume.grid, "MET_FLOAT", voxels));
        write_bytes(folder / "v.nii", test::nifti_file(volume.grid, voxels));
        for (const char* name : {"lps.nrrd", "ras.nrrd", "v.mha", "v.nii"}) {
            SCOPED_TRACE(fmt::format("{} determinant {}", name, direction.determinant()));
            const Volume read = read_volume(folder / name);
            expect_same_place(read.grid, volume.grid);
            EXPECT_EQ(read.values, volume.values);
        }
    }
}

TEST(ImageFiles, writing_and_reading_a_volume_changes_nothing) {
    const Scratch folder;
    for (const float offset : {0.0F, 0.25F}) {  // int16 and float32
        Volume volume = ramp_volume();
        volume.grid.direction = oblique();
        for (float& value : volume.values) value += offset;
        write_volume(folder / "v.nrrd", volume);
        const Volume read = read_volume(folder / "v.nrrd");
        EXPECT_TRUE(same_grid(read.grid, volume.grid));
        EXPECT_EQ(read.values, volume.values);
        EXPECT_NE(test::bytes_of(folder / "v.nrrd").find(offset > 0 ? "type: float" : "type: short"),
                  std::string::npos);
    }
}

TEST(ImageFiles, the_same_volume_gives_the_same_bytes) {
    const Scratch folder;
    write_volume(folder / "a.nrrd", ramp_volume());
    write_volume(folder / "b.nrrd", ramp_volume());
    EXPECT_EQ(test::bytes_of(folder / "a.nrrd"), test::bytes_of(folder / "b.nrrd"));
}

TEST(ImageFiles, header_fields_of_the_input_do_not_reach_the_output) {
    const Scratch folder;
    const Volume volume = ramp_volume();
    write_bytes(folder / "in.nrrd",
                test::nrrd_file(volume.grid, "float", float_bytes(volume), "left-posterior-superior",
                                "content: Jane Roe\nPatientName:=Jane Roe\nStudyDate:=20200102\n"));
    write_volume(folder / "out.nrrd", read_volume(folder / "in.nrrd"));
    const std::string header = test::bytes_of(folder / "out.nrrd");
    for (const char* identity : {"Jane", "PatientName", "20200102", "in.nrrd"})
        EXPECT_EQ(header.find(identity), std::string::npos) << identity;
}

LabelMap small_map() {
    LabelMap map;
    map.grid = ramp_volume().grid;
    map.labels.assign(map.grid.voxel_count(), 0);
    map.labels[3] = 1;
    map.labels[50] = 7;
    map.names = {{1, "skull", {0.25F, 0.5F, 0.75F}}, {7, "soft wall", {1, 0, 0}}};
    return map;
}

TEST(LabelMapFiles, names_values_and_colours_survive_a_round_trip) {
    const Scratch folder;
    for (const std::uint16_t last : {std::uint16_t{7}, std::uint16_t{700}}) {  // uint8 and uint16
        LabelMap map = small_map();
        map.labels[50] = last;
        map.names[1].value = last;
        write_label_map(folder / "l.seg.nrrd", map);
        const LabelMap read = read_label_map(folder / "l.seg.nrrd");
        EXPECT_EQ(read.labels, map.labels);
        ASSERT_EQ(read.names.size(), 2U);
        for (std::size_t i = 0; i < 2; ++i) {
            EXPECT_EQ(read.names[i].value, map.names[i].value);
            EXPECT_EQ(read.names[i].name, map.names[i].name);
            EXPECT_EQ(read.names[i].colour, map.names[i].colour);
        }
    }
}

TEST(LabelMapFiles, as_nifti_they_keep_every_voxel_and_as_a_bids_table_their_names) {
    const Scratch folder;
    for (const std::uint16_t last : {std::uint16_t{7}, std::uint16_t{700}}) {  // uint8 and uint16
        LabelMap map = small_map();
        map.labels[50] = last;
        map.names[1] = {last, "soft\twall", {1, 0, 0}};
        write_nifti_labels(folder / "l_dseg.nii.gz", map);
        write_nifti_labels(folder / "again_dseg.nii.gz", map);
        EXPECT_EQ(test::bytes_of(folder / "l_dseg.nii.gz"), test::bytes_of(folder / "again_dseg.nii.gz"));
        write_bytes(folder / "l_dseg.tsv", bids_label_table(map.names));
        LabelMap read = read_label_map(folder / "l_dseg.nii.gz");
        name_labels(read, folder / "l_dseg.tsv");
        EXPECT_EQ(read.labels, map.labels);
        EXPECT_TRUE(same_grid(read.grid, map.grid));
        ASSERT_EQ(read.names.size(), 2U);
        EXPECT_EQ(read.names[0].name, "skull");
        EXPECT_EQ(read.names[1].name, "soft wall");
        EXPECT_EQ(read.names[1].value, last);
        EXPECT_EQ(read.names[1].colour, map.names[1].colour);
    }
}

TEST(LabelMapFiles, carry_the_fields_that_slicer_reads_a_segmentation_from) {
    const Scratch folder;
    write_label_map(folder / "l.seg.nrrd", small_map());
    const std::string header = test::bytes_of(folder / "l.seg.nrrd");
    for (const char* line :
         {"type: unsigned char", "Segmentation_MasterRepresentation:=Binary labelmap",
          "Segmentation_ContainedRepresentationNames:=Binary labelmap|", "Segment0_ID:=Segment_1",
          "Segment0_Name:=skull", "Segment0_LabelValue:=1", "Segment0_Layer:=0",
          "Segment0_Color:=0.25 0.5 0.75", "Segment0_Extent:=0 3 0 4 0 5", "Segment1_Name:=soft wall"})
        EXPECT_NE(header.find(line), std::string::npos) << line;
}

TEST(LabelMapFiles, values_without_a_segment_field_are_named_by_value) {
    const Scratch folder;
    const LabelMap map = small_map();
    std::vector<std::int32_t> wide(map.labels.begin(), map.labels.end());
    write_bytes(folder / "l.nrrd", test::nrrd_file(map.grid, "int", test::raw_bytes<std::int32_t>(wide),
                                                   "left-posterior-superior"));
    std::vector<float> real(map.labels.begin(), map.labels.end());
    write_bytes(folder / "l.nii", test::nifti_file(map.grid, test::raw_bytes<float>(real)));
    for (const char* name : {"l.nrrd", "l.nii"}) {
        const LabelMap read = read_label_map(folder / name);
        EXPECT_EQ(read.labels, map.labels);
        ASSERT_EQ(read.names.size(), 2U);
        EXPECT_EQ(read.names[1].name, "label_7");
    }
}

TEST(LabelMapFiles, of_more_labels_than_a_header_may_list_are_not_written) {
    const Scratch folder;
    LabelMap map{ramp_volume().grid, {}, {}};
    map.grid.size = {10, 10, 14};
    map.labels.resize(map.grid.voxel_count());
    for (std::uint16_t value = 1; value <= 1300; ++value) {
        map.labels[value] = value;
        map.names.push_back({value, fmt::format("label_{}", value), default_label_colour(value)});
    }
    write_label_map(folder / "l.seg.nrrd", map);
    EXPECT_EQ(read_label_map(folder / "l.seg.nrrd").names.size(), 1300U);
    map.names.push_back({1301, "one more", default_label_colour(1301)});
    EXPECT_SAYS(refusal_of([&] { write_label_map(folder / "m.seg.nrrd", map); }),
                "holds 1301 labels (expected 1300 at most); choose a label map, not a grey volume");
}

TEST(LabelMapFiles, grey_values_and_empty_maps_are_refused) {
    const Scratch folder;
    LabelMap map = small_map();
    write_bytes(folder / "grey.nrrd", test::nrrd_file(ramp_volume().grid, "float", float_bytes(ramp_volume()),
                                                      "left-posterior-superior"));
    EXPECT_NE(refusal_of([&] { read_label_map(folder / "grey.nrrd"); }).find("value -7"), std::string::npos);
    std::ranges::fill(map.labels, std::uint16_t{0});
    write_label_map(folder / "none.seg.nrrd", map);
    EXPECT_NE(refusal_of([&] { read_label_map(folder / "none.seg.nrrd"); }).find("background"),
              std::string::npos);
}

TEST(ImageFiles, bad_inputs_are_refused_with_their_fault) {
    const Scratch folder;
    Volume volume = ramp_volume();
    const auto nrrd = [&](const Volume& v) {
        return test::nrrd_file(v.grid, "float", float_bytes(v), "left-posterior-superior");
    };
    const auto refusal = [&](const std::string& name, const std::string& bytes) {
        write_bytes(folder / name, bytes);
        return refusal_of([&] { read_volume(folder / name); });
    };
    EXPECT_NE(refusal_of([&] { read_volume(folder / "absent.nrrd"); }).find("no such file"),
              std::string::npos);
    EXPECT_NE(refusal_of([&] { read_volume(folder.path()); }).find("no DICOM image series"),
              std::string::npos);
    EXPECT_NE(refusal("text.nrrd", "hello").find("not a volume"), std::string::npos);
    EXPECT_NE(refusal("empty.mha", "").find("not a volume"), std::string::npos);

    Volume constant = volume;
    std::ranges::fill(constant.values, 3.0F);
    EXPECT_NE(refusal("constant.nrrd", nrrd(constant)).find("every voxel is 3"), std::string::npos);

    Volume holed = volume;
    holed.values[volume.grid.offset(2, 1, 3)] = std::nanf("");
    EXPECT_NE(refusal("nan.nrrd", nrrd(holed)).find("voxel (2, 1, 3) is nan"), std::string::npos);

    Volume sheared = volume;
    sheared.grid.direction(0, 1) = 0.01;
    EXPECT_NE(refusal("sheared.nrrd", nrrd(sheared)).find("off orthonormality"), std::string::npos);

    Volume flat = volume;
    flat.grid.size = {20, 6, 1};
    EXPECT_NE(refusal("flat.nrrd", nrrd(flat)).find("flat: 20 x 6 x 1"), std::string::npos);
}

TEST(ImageFiles, truncated_files_of_every_format_are_refused) {
    const Scratch folder;
    const Volume volume = ramp_volume();
    write_volume(folder / "whole.nrrd", volume);
    const std::map<std::string, std::string> files{
        {"raw.nrrd", test::nrrd_file(volume.grid, "float", float_bytes(volume), "left-posterior-superior")},
        {"gzip.nrrd", test::bytes_of(folder / "whole.nrrd")},
        {"v.mha", test::meta_file(volume.grid, "MET_FLOAT", float_bytes(volume))},
        {"v.nii", test::nifti_file(volume.grid, float_bytes(volume))}};
    for (const auto& [name, bytes] : files)
        for (const std::size_t missing : {std::size_t{20}, std::size_t{200}}) {
            write_bytes(folder / name, bytes.substr(0, bytes.size() - missing));
            EXPECT_THROW(read_volume(folder / name), InvalidInput) << name << " without " << missing;
        }
}

TEST(ImageFiles, directions_slightly_off_are_made_orthonormal_and_reported) {
    const Scratch folder;
    Volume volume = ramp_volume();
    volume.grid.direction(0, 1) = 4e-4;
    write_bytes(folder / "v.nrrd",
                test::nrrd_file(volume.grid, "float", float_bytes(volume), "left-posterior-superior"));
    std::string notes;
    const Volume read = read_volume(folder / "v.nrrd", [&](std::string_view note) { notes += note; });
    const Eigen::Matrix3d product = read.grid.direction.transpose() * read.grid.direction;
    EXPECT_LT((product - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NE(notes.find("orthonormal"), std::string::npos);
}

TEST(ImageFiles, outputs_with_another_ending_are_refused) {
    EXPECT_THROW(require_ending("volume.mha", ".nrrd"), InvalidInput);
    EXPECT_THROW(require_ending("labels.nrrd", ".seg.nrrd"), InvalidInput);
    EXPECT_NO_THROW(require_ending("labels.seg.nrrd", ".nrrd"));
}

TEST(ImageFiles, a_file_that_cannot_be_written_whole_is_a_system_failure) {
    const Scratch folder;
    Volume volume = ramp_volume();
    volume.grid.size = {32, 32, 32};
    volume.values.resize(volume.grid.voxel_count());
    std::uint32_t state = 1;  // noise, which gzip cannot shrink
    for (float& value : volume.values)
        value = static_cast<float>((state = state * 1664525U + 1013904223U) >> 17);
    write_volume(folder / "whole.nrrd", volume);
    const auto bytes = std::filesystem::file_size(folder / "whole.nrrd");
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    for (const std::uintmax_t missing : {std::uintmax_t{1}, std::uintmax_t{4}, bytes / 2, bytes - 10}) {
        const rlimit limit{bytes - missing, before.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
        EXPECT_THROW(write_volume(folder / "cut.nrrd", volume), SystemFailure) << missing;
        setrlimit(RLIMIT_FSIZE, &before);
    }
    EXPECT_THROW(write_volume(folder / "no_such_folder/v.nrrd", volume), SystemFailure);
}

}  // namespace
}  // namespace palpate
