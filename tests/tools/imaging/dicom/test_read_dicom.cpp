// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/tools/imaging/dicom/hand_written_dicom.hpp"
#include "tests/tools/imaging/dicom/transcoded_dicom.hpp"
#include "tests/tools/imaging/refusals.hpp"
#include "tools/imaging/files/image_files.hpp"

namespace palpate {
namespace {

using namespace imaging;
using sample::Scratch;
using test::DicomData;

// Positions are written with nine digits; interpolation adds float32 round-off of a few hundred.
constexpr double place_tolerance = 1e-5, value_tolerance = 2e-2;

ImageGrid oblique_stack() {
    ImageGrid grid;
    grid.size = {12, 10, 8};
    grid.spacing = {0.75, 0.5, 2};
    grid.origin = {-40.5, 20.25, 310};
    grid.direction = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    return grid;
}

// Linear in place, so that linear interpolation is exact.
double field(const Eigen::Vector3d& p_P) {
    return 300 + Eigen::Vector3d(3, -5, 2).dot(p_P - Eigen::Vector3d(-40, 20, 310));
}

// A slice of field() whose first voxel lies at p_P, in steps of a hundredth.
DicomData slice_at(const ImageGrid& grid, const Eigen::Vector3d& p_P) {
    ImageGrid plane = grid;
    plane.origin = p_P;
    std::vector<std::int16_t> stored;
    for (int j = 0; j < grid.size[1]; ++j)
        for (int i = 0; i < grid.size[0]; ++i)
            stored.push_back(static_cast<std::int16_t>(
                std::lround(100 * (field(plane.point_of({1.0 * i, 1.0 * j, 0})) - 300))));
    return test::ct_slice(grid, p_P, stored, 0.01, 300);
}

Eigen::Vector3d place_of(const ImageGrid& grid, double k) {
    return grid.point_of(Eigen::Vector3d(0, 0, k));
}

// Slices at the given multiples of the slice distance, under names in another order.
void write_stack(const Scratch& folder, const ImageGrid& grid, const std::vector<double>& places,
                 const std::function<void(DicomData&, std::size_t)>& change = {}) {
    for (std::size_t n = 0; n < places.size(); ++n) {
        DicomData slice = slice_at(grid, place_of(grid, places[n]));
        if (change) change(slice, n);
        test::write_bytes(folder / fmt::format("{}.dcm", n * 5 % 11), slice.file());
    }
}

const std::vector<double> even{0, 1, 2, 3, 4, 5, 6, 7};

void expect_the_field(const Volume& volume, const ImageGrid& within) {
    std::size_t inside = 0, offset = 0;
    for (int k = 0; k < volume.grid.size[2]; ++k)
        for (int j = 0; j < volume.grid.size[1]; ++j)
            for (int i = 0; i < volume.grid.size[0]; ++i, ++offset) {
                const Eigen::Vector3d p_P = volume.grid.point_of({1.0 * i, 1.0 * j, 1.0 * k});
                const Eigen::Vector3d index = within.index_of(p_P);
                if (index.minCoeff() < -1e-6 || index[0] > within.size[0] - 1 + 1e-6 ||
                    index[1] > within.size[1] - 1 + 1e-6)
                    continue;
                ++inside;
                ASSERT_NEAR(volume.values[offset], field(p_P), value_tolerance) << i << ' ' << j << ' ' << k;
            }
    EXPECT_GE(inside, within.voxel_count() / 2);
}

ReadOptions accepting_gaps() {
    ReadOptions options;
    options.accept_gaps = true;
    return options;
}

TEST(Dicom, slices_in_any_order_with_their_own_slopes_make_the_volume_in_its_place) {
    const Scratch folder;
    const ImageGrid grid = oblique_stack();
    // Thickness 3 mm at a distance of 2 mm: overlapping slices.
    write_stack(folder, grid, even, [&](DicomData& slice, std::size_t n) {
        if (n % 2 == 0) return;
        const std::vector<std::int16_t> stored(120, static_cast<std::int16_t>(n));
        slice = test::ct_slice(grid, place_of(grid, even[n]), stored, 0.5 * static_cast<double>(n), -1024);
    });
    const Volume volume = read_volume(folder.path());
    EXPECT_EQ(volume.grid.size, grid.size);
    for (const Eigen::Vector3d& index : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(11, 9, 7)})
        EXPECT_LT((volume.grid.point_of(index) - grid.point_of(index)).norm(), place_tolerance);
    for (int k = 0; k < 8; ++k) {
        const double expected = k % 2 ? 0.5 * k * k - 1024 : field(grid.point_of({3, 4, 1.0 * k}));
        EXPECT_NEAR(volume.values[grid.offset(3, 4, k)], expected, value_tolerance) << k;
    }
}

TEST(Dicom, twelve_bits_with_sign_keep_their_sign_and_negative_first_photometry_its_values) {
    const Scratch folder;
    const ImageGrid grid = oblique_stack();
    for (int k = 0; k < 8; ++k) {
        std::vector<std::int16_t> stored(120, 0x0FFB);  // -5 in twelve bits
        stored[7] = static_cast<std::int16_t>(k);
        test::write_bytes(folder / fmt::format("{}.dcm", k), test::ct_slice(grid, place_of(grid, k), stored)
                                                                 .us(0x00280101, 12)
                                                                 .us(0x00280102, 11)
                                                                 .text(0x00280004, "CS", "MONOCHROME1")
                                                                 .file());
    }
    const Volume volume = read_volume(folder.path());
    EXPECT_EQ(volume.values[0], -5);
    EXPECT_EQ(volume.values[grid.offset(7, 0, 6)], 6);
}

TEST(Dicom, a_header_that_claims_more_than_the_files_hold_is_refused_before_memory_is_taken) {
    const Scratch folder;
    ImageGrid huge = oblique_stack();
    huge.size = {65000, 65000, 8};
    for (int k = 0; k < 8; ++k)
        test::write_bytes(folder / fmt::format("{}.dcm", k),
                          test::ct_slice(huge, place_of(huge, k), std::vector<std::int16_t>(120, 1)).file());
    EXPECT_SAYS(test::volume_refusal(folder.path()), "fewer voxels than its header claims");
}

TEST(Dicom, every_lossless_compression_reads_as_the_same_values) {
    const Scratch plain;
    const ImageGrid grid = oblique_stack();
    write_stack(plain, grid, even);
    const Volume expected = read_volume(plain.path());
    for (const auto syntax :
         {gdcm::TransferSyntax::JPEGLSLossless, gdcm::TransferSyntax::JPEG2000Lossless,
          gdcm::TransferSyntax::RLELossless, gdcm::TransferSyntax::JPEGLosslessProcess14_1}) {
        SCOPED_TRACE(gdcm::TransferSyntax::GetTSString(syntax));
        const Scratch packed;
        for (const auto& entry : std::filesystem::directory_iterator(plain.path())) {
            test::write_bytes(packed / entry.path().filename(),
                              test::transcoded(test::bytes_of(entry.path()), syntax));
        }
        const Volume volume = read_volume(packed.path());
        EXPECT_TRUE(same_grid(volume.grid, expected.grid));
        EXPECT_EQ(volume.values, expected.values);
    }
}

TEST(Dicom, compressed_values_in_the_upper_bits_are_read_as_plain_ones_are) {
    const Scratch folder;
    const ImageGrid grid = oblique_stack();
    for (int k = 0; k < 8; ++k) {
        std::vector<std::int16_t> stored(120, static_cast<std::int16_t>(16 * k));
        stored[7] = -5 * 16;
        std::string file = test::transcoded(test::ct_slice(grid, place_of(grid, k), stored).file(),
                                            gdcm::TransferSyntax::JPEGLosslessProcess14_1);
        const std::string used("\x28\x00\x01\x01US\x02\x00\x10", 9);
        ASSERT_NE(file.find(used), std::string::npos);
        file[file.find(used) + 8] = 12;  // bits, up to the highest of 16
        test::write_bytes(folder / fmt::format("{}.dcm", k), file);
    }
    const Volume volume = read_volume(folder.path());
    EXPECT_EQ(volume.values[grid.offset(0, 0, 6)], 6);
    EXPECT_EQ(volume.values[7], -5);
}

TEST(Dicom, empty_and_missing_identifiers_do_not_split_a_series) {
    const Scratch folder;
    write_stack(folder, oblique_stack(), even, [](DicomData& slice, std::size_t n) {
        for (const std::uint32_t tag : {0x00080018U, 0x0020000dU, 0x0020000eU})
            n % 2 ? slice.erase(tag) : static_cast<void>(slice.text(tag, "UI", ""));
    });
    EXPECT_EQ(read_volume(folder.path()).grid.size[2], 8);
}

TEST(Dicom, several_series_are_listed_and_one_is_chosen_by_number_uid_or_description) {
    const Scratch folder;
    ImageGrid grid = oblique_stack();
    std::filesystem::create_directories(folder / "a");
    std::filesystem::create_directories(folder / "b");
    const auto write = [&](const std::string& sub, const std::string& number, const std::string& uid,
                           const std::string& description, int count) {
        for (int k = 0; k < count; ++k)
            test::write_bytes(folder / fmt::format("{}/{}.dcm", sub, k),
                              slice_at(grid, place_of(grid, k))
                                  .text(0x00200011, "IS", number)
                                  .text(0x0020000e, "UI", uid)
                                  .text(0x0008103e, "LO", description)
                                  .file());
    };
    write("a", "12", "1.2.7.1", "arterial", 8);
    write("b", "3", "1.2.7.2", "venous", 6);
    const auto list = list_series(folder.path());
    ASSERT_EQ(list.size(), 2U);
    EXPECT_EQ(list[0].number, "3");
    EXPECT_EQ(list[0].description, "venous");
    EXPECT_EQ(list[1].size, grid.size);
    EXPECT_LT((list[1].spacing - grid.spacing).norm(), place_tolerance);

    const std::string refusal = test::volume_refusal(folder.path());
    EXPECT_SAYS(refusal, "holds 2 series");
    EXPECT_SAYS(refusal, "12: CT 8 slices of 10 x 12, 0.75 x 0.5 x 2 mm");
    EXPECT_SAYS(refusal, "palpate import ... --series 3");
    EXPECT_EQ(refusal.find("arterial"), std::string::npos) << "may identify a patient";
    ReadOptions shown;
    shown.show_descriptions = true;
    EXPECT_SAYS(test::volume_refusal(folder.path(), shown), "0.75 x 0.5 x 2 mm, \"arterial\"");
    for (const char* wanted : {"3", "1.2.7.2", "venous"}) {
        ReadOptions options;
        options.series = wanted;
        EXPECT_EQ(read_volume(folder.path(), {}, options).grid.size[2], 6) << wanted;
    }
    ReadOptions options;
    options.series = "delayed";
    EXPECT_SAYS(test::volume_refusal(folder.path(), options), "no series are 'delayed'");

    // Numbers that are not distinct give way to places in the list.
    write("b", "12", "1.2.7.2", "venous", 6);
    EXPECT_EQ(list_series(folder.path())[1].number, "2");
}

TEST(Dicom, texts_of_other_alphabets_are_listed_as_utf8_and_only_codes_pass_for_a_modality) {
    const Scratch folder;
    write_stack(folder, oblique_stack(), even, [](DicomData& slice, std::size_t) {
        slice.text(0x0008103e, "LO", "Oberbauch ven\xf6s\n").text(0x00080060, "CS", "ROE JANE");
    });
    std::string notes;
    EXPECT_EQ(list_series(folder.path())[0].description, "Oberbauch ven\xc3\xb6s ");
    EXPECT_EQ(list_series(folder.path())[0].modality, "other");
    read_volume(folder.path(), [&](std::string_view note) { notes += note; });
    EXPECT_SAYS(notes, "modality other");
    EXPECT_EQ(notes.find("ROE"), std::string::npos);
}

TEST(Dicom, scouts_and_localizers_beside_a_volume_need_no_choice) {
    const Scratch folder;
    const ImageGrid grid = oblique_stack();
    write_stack(folder, grid, even);
    test::write_bytes(folder / "scout.dcm",
                      slice_at(grid, place_of(grid, 0)).text(0x0020000e, "UI", "1.2.9").file());
    for (int k = 0; k < 5; ++k)  // in the same series by its UID
        test::write_bytes(folder / fmt::format("localizer{}.dcm", k),
                          slice_at(grid, place_of(grid, 3 * k))
                              .text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\LOCALIZER")
                              .file());
    std::string notes;
    EXPECT_EQ(read_volume(folder.path(), [&](std::string_view note) { notes += note; }).grid.size[2], 8);
    EXPECT_SAYS(notes, "3 series; reading number");
    ReadOptions options;
    options.series = "1.2.3.4.5.1";
    EXPECT_EQ(read_volume(folder.path(), {}, options).grid.size[2], 8);
    EXPECT_EQ(notes.find("portal"), std::string::npos) << "a note tells text of the input";
}

TEST(Dicom, files_that_are_no_images_are_skipped_with_a_note) {
    const Scratch folder;
    const ImageGrid grid = oblique_stack();
    write_stack(folder, grid, even);
    for (const char* kind : {"SEG", "RTSTRUCT", "SR"})
        test::write_bytes(folder / kind,
                          slice_at(grid, place_of(grid, 0)).text(0x00080060, "CS", kind).file());
    test::write_bytes(folder / "DICOMDIR", DicomData().text(0x00041130, "CS", "DISC").file());
    test::write_bytes(folder / "notes.txt", "not DICOM");
    std::string notes;
    EXPECT_EQ(read_volume(folder.path(), [&](std::string_view note) { notes += note; }).grid.size[2], 8);
    for (const char* kind : {"SEG", "RTSTRUCT", "SR", "DICOMDIR"}) EXPECT_SAYS(notes, kind);
}

TEST(Dicom, a_missing_slice_is_refused_with_its_place_and_interpolated_on_request) {
    const Scratch folder;
    const ImageGrid grid = oblique_stack();
    write_stack(folder, grid, {0, 1, 2, 3, 5, 6, 7});
    const std::string refusal = test::volume_refusal(folder.path());
    EXPECT_SAYS(refusal, "4.000 mm between the slices at");
    EXPECT_SAYS(refusal, "4.dcm and 9.dcm");  // 3 * 5 % 11 and 4 * 5 % 11
    EXPECT_SAYS(refusal, "expected 2.000 mm");
    EXPECT_SAYS(refusal, "--accept-gaps");
    std::string notes;
    const Volume volume = read_volume(
        folder.path(), [&](std::string_view note) { notes += note; }, accepting_gaps());
    EXPECT_EQ(volume.grid.size, grid.size);
    expect_the_field(volume, grid);
    EXPECT_SAYS(notes, "7 slices interpolated onto 8");
}

TEST(Dicom, uneven_slices_are_refused_and_interpolated_on_request) {
    const Scratch folder;
    const ImageGrid grid = oblique_stack();
    write_stack(folder, grid, {0, 1, 2, 3.3, 4, 5, 6, 7});
    EXPECT_SAYS(test::volume_refusal(folder.path()), "2.600 mm between");
    const Volume volume = read_volume(folder.path(), {}, accepting_gaps());
    EXPECT_EQ(volume.grid.size, grid.size);
    expect_the_field(volume, grid);
}

TEST(Dicom, a_tilted_gantry_is_refused_with_its_angle_and_untilted_on_request) {
    const Scratch folder;
    const ImageGrid grid = oblique_stack();
    const double shift = 2 * std::tan(15 * M_PI / 180);  // mm a slice
    for (int k = 0; k < 8; ++k)
        test::write_bytes(folder / fmt::format("{}.dcm", k),
                          slice_at(grid, place_of(grid, k) + k * shift * grid.direction.col(1)).file());
    const std::string refusal = test::volume_refusal(folder.path());
    EXPECT_SAYS(refusal, "gantry tilt of 15.0 degrees");
    EXPECT_SAYS(refusal, "0.dcm and 1.dcm");
    const Volume volume = read_volume(folder.path(), {}, accepting_gaps());
    EXPECT_EQ(volume.grid.size[2], 8);
    EXPECT_EQ(volume.grid.size[1], 10 + static_cast<int>(std::ceil(7 * shift / 0.5)));
    EXPECT_LT((volume.grid.direction - grid.direction).norm(), place_tolerance);
    // Where each slice lies, the field is untilted; outside it holds the lowest value.
    std::size_t inside = 0;
    for (int k = 0; k < 8; ++k)
        for (int j = 0; j < volume.grid.size[1]; ++j) {
            const double from_slice = j * 0.5 - k * shift;
            const float value = volume.values[volume.grid.offset(4, j, k)];
            if (from_slice >= 0 && from_slice <= 4.5) {
                ++inside;
                EXPECT_NEAR(value, field(volume.grid.point_of({4, 1.0 * j, 1.0 * k})), value_tolerance);
            } else {
                EXPECT_EQ(value, std::ranges::min(volume.values));
            }
        }
    EXPECT_GE(inside, 8U * 9U);
}

TEST(Dicom, tilt_and_spacing_that_creep_are_refused_and_resampled_on_request) {
    const ImageGrid grid = oblique_stack();
    const double shift = 2 * std::tan(1.1 * M_PI / 180);  // 0.038 mm a slice, less than 2 %
    std::vector<double> creeping{0};
    for (int n = 0; n < 50; ++n) creeping.push_back(creeping.back() + (n < 25 ? 0.965 : n > 25 ? 1.035 : 1));
    ImageGrid fine = grid;
    fine.spacing[2] = 0.275;  // so that distances may differ by 4 %
    const Scratch tilted, uneven;
    for (int k = 0; k < 8; ++k)
        test::write_bytes(tilted / fmt::format("{}.dcm", k),
                          slice_at(grid, place_of(grid, k) + k * shift * grid.direction.col(1)).file());
    for (std::size_t k = 0; k < creeping.size(); ++k)
        test::write_bytes(uneven / fmt::format("{}.dcm", k),
                          slice_at(fine, place_of(fine, creeping[k])).file());
    EXPECT_SAYS(test::volume_refusal(tilted.path()), "gantry tilt of 1.1 degrees");
    EXPECT_SAYS(test::volume_refusal(tilted.path()), "between 0.dcm and 7.dcm");
    EXPECT_GT(read_volume(tilted.path(), {}, accepting_gaps()).grid.size[1], grid.size[1]);
    const std::string refusal = test::volume_refusal(uneven.path());
    EXPECT_SAYS(refusal, "off its place in an even stack");
    expect_the_field(read_volume(uneven.path(), {}, accepting_gaps()), fine);
}

TEST(Dicom, links_that_lead_nowhere_or_to_themselves_are_no_slices) {
    const Scratch folder;
    write_stack(folder, oblique_stack(), even);
    std::filesystem::create_symlink("loop", folder / "loop");
    std::filesystem::create_symlink("missing", folder / "broken");
    EXPECT_EQ(read_volume(folder.path()).grid.size[2], 8);
    EXPECT_SAYS(test::volume_refusal(folder / "loop"), "no such file");
}

TEST(Dicom, doubled_slices_are_refused_and_left_out_on_request_only_if_identical) {
    const Scratch folder;
    const ImageGrid grid = oblique_stack();
    write_stack(folder, grid, {0, 1, 2, 3, 3, 4, 5, 6, 7});
    EXPECT_SAYS(test::volume_refusal(folder.path()), "two slices lie at one place");
    const Volume volume = read_volume(folder.path(), {}, accepting_gaps());
    EXPECT_EQ(volume.grid.size, grid.size);
    expect_the_field(volume, grid);
    write_stack(folder, grid, {0, 1, 2, 3, 3, 4, 5, 6, 7}, [](DicomData& slice, std::size_t n) {
        if (n == 4) slice.text(0x00281052, "DS", "17");
    });
    EXPECT_SAYS(test::volume_refusal(folder.path(), accepting_gaps()), "lie at one place and differ");
}

TEST(Dicom, mixed_damaged_coloured_and_placeless_slices_are_refused_by_name) {
    const ImageGrid grid = oblique_stack();
    ImageGrid turned = grid, small = grid;
    turned.direction.col(1) *= -1;
    small.size = {6, 10, 8};
    const auto refusal = [&](const std::function<void(DicomData&)>& change) {
        const Scratch folder;
        write_stack(folder, grid, even, [&](DicomData& slice, std::size_t n) {
            if (n == 3) change(slice);  // 4.dcm
        });
        return test::volume_refusal(folder.path());
    };
    EXPECT_SAYS(refusal([&](DicomData& s) { s = slice_at(small, place_of(grid, 3)); }), "size of 4.dcm");
    EXPECT_SAYS(refusal([&](DicomData& s) { s = slice_at(turned, place_of(grid, 3)); }),
                "direction of 4.dcm");
    EXPECT_SAYS(refusal([&](DicomData& s) { s.text(0x00280030, "DS", "1\\1"); }), "spacing of 4.dcm");
    EXPECT_SAYS(refusal([&](DicomData& s) { s.text(0x00280004, "CS", "PALETTE COLOR"); }),
                "holds colours (PALETTE COLOR)");
    EXPECT_SAYS(refusal([&](DicomData& s) { s.text(0x00280004, "CS", "ROE JANE"); }), "colours (other)");
    EXPECT_SAYS(refusal([&](DicomData& s) { s.text(0x00200032, "DS", "0\\nan\\0"); }),
                "4.dcm says not where");
    for (const std::uint32_t rescale : {0x00281052U, 0x00281053U})
        EXPECT_SAYS(refusal([&](DicomData& s) { s.text(rescale, "DS", "nan"); }), "is no number");
    EXPECT_SAYS(refusal([&](DicomData& s) { s.text(0x00200032, "DS", "0\\0\\inf"); }),
                "4.dcm says not where");
    EXPECT_SAYS(refusal([&](DicomData& s) { s.erase(0x00200032); }), "4.dcm says not where");
    EXPECT_SAYS(refusal([&](DicomData& s) { s.text(0x7fe00010, "OW", std::string(100, '\1')); }), "4.dcm: ");
    const Scratch folder;
    write_stack(folder, grid, even);
    const std::string whole = test::bytes_of(folder / "4.dcm");
    for (const std::size_t missing : {10U, 200U}) {
        test::write_bytes(folder / "4.dcm", whole.substr(0, whole.size() - missing));
        EXPECT_SAYS(test::volume_refusal(folder.path()), "4.dcm") << missing;
    }
}

TEST(Dicom, an_enhanced_file_of_several_frames_reads_as_the_same_volume) {
    const ImageGrid grid = oblique_stack();
    const Scratch folder, slices;
    write_stack(slices, grid, even);
    const Volume expected = read_volume(slices.path());
    const std::vector<int> order{3, 0, 7, 1, 6, 2, 5, 4};
    std::vector<std::int16_t> stored;
    for (const int k : order)
        for (int j = 0; j < grid.size[1]; ++j)
            for (int i = 0; i < grid.size[0]; ++i)
                stored.push_back(static_cast<std::int16_t>(
                    std::lround(100 * (double{expected.values[grid.offset(i, j, k)]} - 300) / (k + 1))));
    test::write_bytes(folder / "enhanced.dcm", test::enhanced_ct(grid, stored, order).file());
    for (const auto& path : {folder.path(), folder / "enhanced.dcm"}) {
        const Volume volume = read_volume(path);
        EXPECT_TRUE(same_grid(volume.grid, expected.grid));
        for (std::size_t n = 0; n < expected.values.size(); ++n)
            ASSERT_NEAR(volume.values[n], expected.values[n], 0.05);  // half a step of the coarsest slope
    }
}

}  // namespace
}  // namespace palpate
