// SPDX-License-Identifier: GPL-3.0-or-later
// Corners of NIfTI files that strangers meet.
#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <span>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/tools/imaging/hand_written_images.hpp"
#include "tests/tools/imaging/refusals.hpp"
#include "tools/imaging/files/image_files.hpp"

namespace palpate {
namespace {

using namespace imaging;
using sample::Scratch;
using test::expect_same_place;
using test::oblique_ramp;
using test::write_bytes;

template <typename T>
void put(std::string& bytes, std::size_t offset, T value) {
    std::memcpy(bytes.data() + offset, &value, sizeof(value));
}

// The quaternion and offset of a grid, code 1, beside the sform.
void put_qform(std::string& nifti, const ImageGrid& grid) {
    Eigen::Matrix3d rotation = test::scaled_axes(grid, true) * grid.spacing.cwiseInverse().asDiagonal();
    const double qfac = rotation.determinant() < 0 ? -1 : 1;
    rotation.col(2) *= qfac;
    Eigen::Quaterniond q(rotation);
    if (q.w() < 0) q.coeffs() *= -1;
    const Eigen::Vector3d origin = test::origin_in(grid, true);
    put(nifti, 76, static_cast<float>(qfac));
    put(nifti, 252, std::int16_t{1});
    for (int i = 0; i < 3; ++i) {
        put(nifti, static_cast<std::size_t>(256 + 4 * i), static_cast<float>(q.vec()[i]));
        put(nifti, static_cast<std::size_t>(268 + 4 * i), static_cast<float>(origin[i]));
    }
}

ReadOptions framed(const std::string& frame) {
    ReadOptions options;
    options.nifti_frame = frame;
    return options;
}

TEST(Nifti, transforms_that_agree_are_read_and_ones_that_do_not_are_refused_with_both) {
    const Scratch folder;
    for (const bool mirrored : {false, true}) {
        Volume volume = oblique_ramp();
        if (mirrored) volume.grid.direction.col(2) *= -1;
        std::string file = test::nifti_file(volume.grid, test::raw_bytes<float>(volume.values));
        put_qform(file, volume.grid);
        write_bytes(folder / "v.nii", file);
        for (const char* frame : {"", "qform", "sform"})
            expect_same_place(read_volume(folder / "v.nii", {}, framed(frame)).grid, volume.grid);

        ImageGrid moved = volume.grid;
        moved.origin[0] += 0.06;  // 0.12 of the smallest voxel edge
        put_qform(file, moved);
        write_bytes(folder / "v.nii", file);
        const std::string refusal = test::volume_refusal<Error>(folder / "v.nii");
        EXPECT_SAYS(refusal, "qform [");
        EXPECT_SAYS(refusal, "sform [");
        EXPECT_SAYS(refusal, "disagree by 0.12 voxels");
        EXPECT_SAYS(refusal, "--nifti-frame qform");
        expect_same_place(read_volume(folder / "v.nii", {}, framed("qform")).grid, moved);
        expect_same_place(read_volume(folder / "v.nii", {}, framed("sform")).grid, volume.grid);
    }
}

TEST(Nifti, a_transform_that_is_not_set_cannot_be_chosen) {
    const Scratch folder;
    const Volume volume = oblique_ramp();
    write_bytes(folder / "v.nii", test::nifti_file(volume.grid, test::raw_bytes<float>(volume.values)));
    EXPECT_SAYS(test::volume_refusal<Error>(folder / "v.nii", framed("qform")), "has no qform");
    EXPECT_SAYS(test::volume_refusal<Error>(folder / "v.nii", framed("affine")), "'affine'");
}

TEST(Nifti, shear_up_to_a_thousandth_is_repaired_and_reported_and_beyond_refused) {
    const Scratch folder;
    for (const double shear : {9e-4, 1.2e-3}) {
        Volume volume = oblique_ramp();
        volume.grid.direction.col(1) += shear * volume.grid.direction.col(0);
        write_bytes(folder / "v.nii", test::nifti_file(volume.grid, test::raw_bytes<float>(volume.values)));
        if (shear > 1e-3) {
            EXPECT_SAYS(test::volume_refusal<Error>(folder / "v.nii"), "off orthonormality");
            continue;
        }
        std::string notes;
        const Volume read = read_volume(folder / "v.nii", [&](std::string_view note) { notes += note; });
        EXPECT_SAYS(notes, "0.0009 off orthonormality and were made orthonormal");
        EXPECT_LT(
            (read.grid.direction.transpose() * read.grid.direction - Eigen::Matrix3d::Identity()).norm(),
            1e-12);
        EXPECT_LT((read.grid.direction - volume.grid.direction).norm(), 1e-3);
    }
}

TEST(Nifti, a_file_without_transforms_is_read_as_ras_with_a_note) {
    const Scratch folder;
    Volume volume = oblique_ramp();
    volume.grid.direction.setIdentity();
    std::string file = test::nifti_file(volume.grid, test::raw_bytes<float>(volume.values));
    put(file, 254, std::int16_t{0});
    write_bytes(folder / "v.nii", file);
    std::string notes;
    const Volume read = read_volume(folder / "v.nii", [&](std::string_view note) { notes += note; });
    EXPECT_SAYS(notes, "neither qform nor sform");
    EXPECT_EQ(read.grid.direction.col(0), Eigen::Vector3d(-1, 0, 0));
}

TEST(Nifti, big_endian_scaled_and_second_version_files_hold_the_same_volume) {
    const Scratch folder;
    const Volume volume = oblique_ramp();
    const std::string little = test::nifti_file(volume.grid, test::raw_bytes<float>(volume.values));

    std::string big = little;
    const auto swap = [&](std::size_t from, std::size_t count, std::size_t width) {
        for (std::size_t i = 0; i < count; ++i)
            std::reverse(big.begin() + static_cast<long>(from + i * width),
                         big.begin() + static_cast<long>(from + (i + 1) * width));
    };
    swap(0, 1, 4);
    swap(40, 8, 2);
    swap(70, 2, 2);
    swap(76, 8, 4);
    swap(108, 3, 4);
    swap(252, 2, 2);
    swap(256, 18, 4);
    swap(352, volume.values.size(), 4);
    write_bytes(folder / "big.nii", big);

    std::string scaled = little.substr(0, 352);  // values -7, -6 ... as 2 * stored - 7, over int16
    put(scaled, 70, std::int16_t{4});
    put(scaled, 112, 0.5F);
    put(scaled, 116, -7.0F);
    for (std::size_t i = 0; i < volume.values.size(); ++i) {
        const auto stored = static_cast<std::int16_t>(2 * i);
        scaled += test::raw_bytes<std::int16_t>(std::span(&stored, 1));
    }
    write_bytes(folder / "scaled.nii", scaled);

    std::string second(544, '\0');
    put(second, 0, std::int32_t{540});
    std::memcpy(second.data() + 4, "n+2\0\r\n\032\n", 8);
    put(second, 12, std::int16_t{16});
    for (std::size_t i = 0; i < 8; ++i) {
        put(second, 16 + 8 * i, std::int64_t{i == 0 ? 3 : i < 4 ? volume.grid.size[i - 1] : 1});
        put(second, 104 + 8 * i, 1.0);
    }
    put(second, 168, std::int64_t{544});
    put(second, 348, std::int32_t{1});
    const Eigen::Matrix3d axes = test::scaled_axes(volume.grid, true);
    const Eigen::Vector3d origin = test::origin_in(volume.grid, true);
    for (int row = 0; row < 3; ++row) {
        for (int axis = 0; axis < 3; ++axis)
            put(second, static_cast<std::size_t>(400 + 32 * row + 8 * axis), axes(row, axis));
        put(second, static_cast<std::size_t>(400 + 32 * row + 24), origin[row]);
    }
    write_bytes(folder / "second.nii", second + test::raw_bytes<float>(volume.values));

    for (const char* name : {"big.nii", "scaled.nii", "second.nii"}) {
        SCOPED_TRACE(name);
        const Volume read = read_volume(folder / name);
        expect_same_place(read.grid, volume.grid);
        EXPECT_EQ(read.values, volume.values);
    }
}

TEST(Nifti, colours_time_series_pairs_and_false_claims_are_refused) {
    const Scratch folder;
    const Volume volume = oblique_ramp();
    const std::string good = test::nifti_file(volume.grid, test::raw_bytes<float>(volume.values));
    const auto refusal = [&](std::size_t offset, auto value) {
        std::string file = good;
        put(file, offset, value);
        write_bytes(folder / "v.nii", file);
        return test::volume_refusal<Error>(folder / "v.nii");
    };
    EXPECT_SAYS(refusal(70, std::int16_t{128}), "datatype 128");
    EXPECT_SAYS(refusal(344, 'x'), "not a NIfTI file of one piece");
    EXPECT_SAYS(refusal(42, std::int16_t{-4}), "is flat: -4");
    EXPECT_SAYS(refusal(42, std::int16_t{32000}), "fewer voxels than its header claims");
    EXPECT_SAYS(refusal(46, std::int16_t{12}), "fewer voxels than its header claims");
    EXPECT_SAYS(refusal(108, 1e9F), "claims a header");
    std::string series = good;
    put(series, 40, std::int16_t{4});
    put(series, 48, std::int16_t{2});
    write_bytes(folder / "v.nii", series);
    EXPECT_SAYS(test::volume_refusal<Error>(folder / "v.nii"), "has sizes 4 5 6 2");
}

TEST(Nifti, labels_whose_slope_is_rounded_to_float32_are_whole) {
    const Scratch folder;
    ImageGrid grid;
    grid.size = {2, 2, 2};
    const std::vector<float> voxels{0, 255, 0, 255, 510, 0, 0, 255};
    std::string file = test::nifti_file(grid, test::raw_bytes<float>(voxels));
    const auto with_slope = [&](float slope) {
        std::memcpy(file.data() + 112, &slope, sizeof(slope));
        write_bytes(folder / "l.nii", file);
    };
    with_slope(1.0F / 255);
    EXPECT_EQ(read_label_map(folder / "l.nii").labels, (std::vector<std::uint16_t>{0, 1, 0, 1, 2, 0, 0, 1}));
    with_slope(1.0F / 254);
    EXPECT_THROW(read_label_map(folder / "l.nii"), InvalidInput);
}

}  // namespace
}  // namespace palpate
