// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/tools/imaging/dicom/hand_written_dicom.hpp"
#include "tests/tools/imaging/refusals.hpp"
#include "tools/imaging/files/image_files.hpp"

namespace palpate {
namespace {

using namespace imaging;
using sample::Scratch;
using test::DicomData;

ImageGrid small_grid() {
    ImageGrid grid;
    grid.size = {6, 5, 7};
    grid.spacing = {0.75, 0.5, 2};
    grid.origin = {-40.5, 20.25, 310};
    grid.direction = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    return grid;
}

// One slice of one segment: the segment's number, the slice and the pixels that are set.
struct Frame {
    int segment;
    double slice;
    std::vector<int> pixels;
};

DicomData code(const std::string& value, const std::string& meaning) {
    return DicomData()
        .text(0x00080100, "SH", value)
        .text(0x00080102, "SH", "SCT")
        .text(0x00080104, "LO", meaning);
}

std::string segmentation(const ImageGrid& grid, const std::vector<std::string>& labels,
                         const std::vector<Frame>& frames, const std::string& type = "BINARY") {
    std::vector<DicomData> segments, groups;
    for (std::size_t n = 0; n < labels.size(); ++n)
        segments.push_back(DicomData()
                               .us(0x00620004, static_cast<int>(n + 1))
                               .text(0x00620005, "LO", labels[n])
                               .text(0x00620008, "CS", "MANUAL")
                               .text(0x0062000d, "US", test::little_endian(0x80808c0088000000ULL >> 16, 6))
                               .sequence(0x00620003, {code("123037004", "Anatomical Structure")})
                               .sequence(0x0062000f, {code("10200004", "Liver")}));
    const std::size_t plane = static_cast<std::size_t>(grid.size[0] * grid.size[1]);
    std::string bits((plane * frames.size() + 7) / 8, '\0');
    for (std::size_t f = 0; f < frames.size(); ++f) {
        for (const int pixel : frames[f].pixels) {
            const std::size_t bit = f * plane + static_cast<std::size_t>(pixel);
            bits[bit / 8] = static_cast<char>(bits[bit / 8] | 1 << bit % 8);
        }
        groups.push_back(
            DicomData()
                .sequence(0x00209111, {DicomData()
                                           .text(0x00209056, "SH", "1")
                                           .text(0x00209157, "UL", std::string("\1\0\0\0", 4))})
                .sequence(0x00209113,
                          {DicomData().text(0x00200032, "DS",
                                            test::decimals(grid.point_of({0, 0, frames[f].slice})))})
                .sequence(0x0062000a, {DicomData().us(0x0062000b, frames[f].segment)}));
    }
    const DicomData shared =
        DicomData()
            .sequence(0x00209116, {DicomData().text(0x00200037, "DS", test::orientation(grid))})
            .sequence(0x00289110,
                      {DicomData()
                           .text(0x00180050, "DS", test::decimals({grid.spacing[2]}))
                           .text(0x00280030, "DS", test::decimals({grid.spacing[1], grid.spacing[0]}))});
    return DicomData()
        .text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.66.4")
        .text(0x00080018, "UI", "1.2.3.4")
        .text(0x00080060, "CS", "SEG")
        .text(0x00100010, "PN", "ROE^JANE")
        .text(0x0020000d, "UI", "1.2.3.4.5")
        .text(0x0020000e, "UI", "1.2.3.4.5.9")
        .us(0x00280002, 1)
        .text(0x00280004, "CS", "MONOCHROME2")
        .text(0x00280008, "IS", std::to_string(frames.size()))
        .us(0x00280010, grid.size[1])
        .us(0x00280011, grid.size[0])
        .us(0x00280100, 1)
        .us(0x00280101, 1)
        .us(0x00280102, 0)
        .us(0x00280103, 0)
        .text(0x00620001, "CS", type)
        .sequence(0x00620002, segments)
        .sequence(0x52009229, {shared})
        .sequence(0x52009230, groups)
        .text(0x7fe00010, "OB", bits)
        .file();
}

std::string label_map_refusal(const std::filesystem::path& path) {
    return test::refusal_of([&] { read_label_map(path); });
}

TEST(DicomSeg, frames_in_any_order_with_empty_slices_left_out_are_the_segments_in_their_place) {
    const Scratch folder;
    const ImageGrid grid = small_grid();
    test::write_bytes(
        folder / "s.dcm",
        segmentation(grid, {"liver", "tumour"}, {{1, 6, {3, 4}}, {2, 2, {29}}, {1, 0, {0}}, {1, 1, {7}}}));
    const LabelMap map = read_label_map(folder / "s.dcm");
    EXPECT_TRUE(same_grid(map.grid, grid));
    ASSERT_EQ(map.names.size(), 2U);
    EXPECT_EQ(map.names[0].name, "liver");
    EXPECT_EQ(map.names[1].name, "tumour");
    std::vector<std::uint16_t> expected(grid.voxel_count(), 0);
    expected[grid.offset(3, 0, 6)] = expected[grid.offset(4, 0, 6)] = 1;
    expected[grid.offset(0, 0, 0)] = expected[grid.offset(1, 1, 1)] = 1;
    expected[grid.offset(5, 4, 2)] = 2;
    EXPECT_EQ(map.labels, expected);
}

TEST(DicomSeg, a_single_slice_gets_an_empty_neighbour_at_its_thickness) {
    const Scratch folder;
    const ImageGrid grid = small_grid();
    test::write_bytes(folder / "s.dcm", segmentation(grid, {"liver"}, {{1, 3, {8}}}));
    const LabelMap map = read_label_map(folder / "s.dcm");
    EXPECT_EQ(map.grid.size, (std::array<std::int32_t, 3>{6, 5, 2}));
    EXPECT_DOUBLE_EQ(map.grid.spacing[2], 2);
    EXPECT_EQ(map.labels[8], 1);
    EXPECT_EQ(std::ranges::count(map.labels, 0), 59);
}

TEST(DicomSeg, overlaps_fractions_frames_off_the_grid_and_images_are_refused) {
    const Scratch folder;
    const ImageGrid grid = small_grid();
    const auto refusal = [&](const std::vector<Frame>& frames, const std::string& type = "BINARY") {
        test::write_bytes(folder / "s.dcm", segmentation(grid, {"liver", "tumour"}, frames, type));
        return label_map_refusal(folder / "s.dcm");
    };
    EXPECT_SAYS(refusal({{1, 0, {1, 2}}, {1, 1, {1}}, {2, 0, {2}}}),
                "'liver' and 'tumour' both claim 1 voxels");
    EXPECT_SAYS(refusal({{1, 0, {1}}, {1, 1, {1}}, {2, 2.4, {2}}}), "lies at slice");
    EXPECT_SAYS(refusal({{1, 0, {1}}, {3, 1, {1}}}), "segment 3, which is missing");
    EXPECT_SAYS(refusal({{1, 0, {1}}, {1, 1, {1}}}, "FRACTIONAL"), "s.dcm");
    test::write_bytes(folder / "ct.dcm",
                      test::ct_slice(grid, grid.origin, std::vector<std::int16_t>(30, 1)).file());
    EXPECT_SAYS(label_map_refusal(folder / "ct.dcm"), "modality 'CT'");
    test::write_bytes(folder / "ct.dcm", test::ct_slice(grid, grid.origin, std::vector<std::int16_t>(30, 1))
                                             .text(0x00080060, "CS", "ROE JANE")
                                             .file());
    EXPECT_SAYS(label_map_refusal(folder / "ct.dcm"), "modality 'other'");
    const std::string whole = segmentation(grid, {"liver"}, {{1, 0, {1}}, {1, 1, {1}}});
    test::write_bytes(folder / "cut.dcm", whole.substr(0, whole.size() - 6));
    EXPECT_SAYS(label_map_refusal(folder / "cut.dcm"), "cannot be read");
}

}  // namespace
}  // namespace palpate
