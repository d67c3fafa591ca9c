// SPDX-License-Identifier: GPL-3.0-or-later
// One organ, sampled along all axis orders and directions, stored in every format, must read as the same
// organ in the same place.
#include <Eigen/Geometry>
#include <algorithm>
#include <gtest/gtest.h>

#include "tests/formats/scratch.hpp"
#include "tests/tools/imaging/dicom/hand_written_dicom.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/voxels/label_statistics.hpp"

namespace palpate {
namespace {

using namespace imaging;

// Float32 headers of NIfTI: 200 mm at 2^-24, over a few terms.
constexpr double centroid_tolerance = 1e-3;

// An organ without any symmetry: a bar along i, a shorter one along j, a shorter one along k, and a nodule.
LabelMap organ(const Eigen::Matrix3d& rotation) {
    LabelMap map;
    map.grid.size = {11, 9, 7};
    map.grid.spacing = {0.75, 1.25, 2};
    map.grid.origin = {-61.25, 102.5, 43};
    map.grid.direction = rotation;
    map.labels.assign(map.grid.voxel_count(), 0);
    for (int i = 2; i < 10; ++i) map.labels[map.grid.offset(i, 2, 1)] = 3;
    for (int j = 2; j < 7; ++j) map.labels[map.grid.offset(2, j, 1)] = 3;
    for (int k = 1; k < 5; ++k) map.labels[map.grid.offset(2, 2, k)] = 3;
    map.labels[map.grid.offset(9, 3, 1)] = 7;
    map.names = {{3, "liver", {}}, {7, "tumour", {}}};
    return map;
}

// The same voxels stored along other axes: axis a of the result is axis order[a] of `map`, backwards if its
// bit is set.
LabelMap stored_along(const LabelMap& map, const std::array<int, 3>& order, unsigned backwards) {
    LabelMap result = map;
    const auto index_in_map = [&](const Eigen::Vector3i& index) {
        Eigen::Vector3i there;
        for (int a = 0; a < 3; ++a) {
            const auto from = static_cast<std::size_t>(order[static_cast<std::size_t>(a)]);
            there[order[static_cast<std::size_t>(a)]] =
                (backwards >> a & 1U) ? map.grid.size[from] - 1 - index[a] : index[a];
        }
        return there;
    };
    for (int a = 0; a < 3; ++a) {
        const int from = order[static_cast<std::size_t>(a)];
        result.grid.size[static_cast<std::size_t>(a)] = map.grid.size[static_cast<std::size_t>(from)];
        result.grid.spacing[a] = map.grid.spacing[from];
        result.grid.direction.col(a) = map.grid.direction.col(from) * ((backwards >> a & 1U) ? -1 : 1);
    }
    result.grid.origin = map.grid.point_of(index_in_map({0, 0, 0}).cast<double>());
    for (int k = 0; k < result.grid.size[2]; ++k)
        for (int j = 0; j < result.grid.size[1]; ++j)
            for (int i = 0; i < result.grid.size[0]; ++i) {
                const Eigen::Vector3i there = index_in_map({i, j, k});
                result.labels[result.grid.offset(i, j, k)] =
                    map.labels[map.grid.offset(there[0], there[1], there[2])];
            }
    return result;
}

void expect_same_organ(const LabelMap& found, const LabelMap& expected) {
    ASSERT_EQ(found.grid.voxel_count(), expected.grid.voxel_count());
    for (int k = 0; k < found.grid.size[2]; ++k)
        for (int j = 0; j < found.grid.size[1]; ++j)
            for (int i = 0; i < found.grid.size[0]; ++i) {
                const Eigen::Vector3d index =
                    expected.grid.index_of(found.grid.point_of({1.0 * i, 1.0 * j, 1.0 * k}));
                const Eigen::Vector3i nearest = index.array().round().cast<int>();
                ASSERT_LT((index - nearest.cast<double>()).norm(), centroid_tolerance);
                ASSERT_TRUE(expected.grid.contains(nearest[0], nearest[1], nearest[2]));
                ASSERT_EQ(found.labels[found.grid.offset(i, j, k)],
                          expected.labels[expected.grid.offset(nearest[0], nearest[1], nearest[2])]);
            }
    const auto statistics = label_statistics(found), wanted = label_statistics(expected);
    ASSERT_EQ(statistics.size(), wanted.size());
    for (std::size_t n = 0; n < wanted.size(); ++n)
        EXPECT_LT((statistics[n].centroid - wanted[n].centroid).norm(), centroid_tolerance);
}

// A volume of the labels as grey values, for formats that hold no label map.
LabelMap as_labels(const Volume& volume) {
    LabelMap map{volume.grid, {}, {{3, "liver", {}}, {7, "tumour", {}}}};
    for (const float value : volume.values) map.labels.push_back(static_cast<std::uint16_t>(value));
    return map;
}

std::string vti_file(const LabelMap& map) {
    std::string direction, values;
    for (int row = 0; row < 3; ++row)
        for (int axis = 0; axis < 3; ++axis) direction += fmt::format("{} ", map.grid.direction(row, axis));
    for (const auto label : map.labels) values += fmt::format("{} ", label);
    const auto& [size, spacing, origin, unused] = map.grid;
    const std::string extent = fmt::format("0 {} 0 {} 0 {}", size[0] - 1, size[1] - 1, size[2] - 1);
    return fmt::format(
        "<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\"><ImageData "
        "WholeExtent=\"{0}\" "
        "Origin=\"{1} {2} {3}\" Spacing=\"{4} {5} {6}\" Direction=\"{7}\"><Piece Extent=\"{0}\"><PointData "
        "Scalars=\"l\"><DataArray type=\"UInt16\" Name=\"l\" format=\"ascii\">{8}</DataArray></PointData>"
        "</Piece></ImageData></VTKFile>",
        extent, origin[0], origin[1], origin[2], spacing[0], spacing[1], spacing[2], direction, values);
}

class Orientation : public ::testing::TestWithParam<int> {};

TEST_P(Orientation, all_48_axis_orders_in_every_format_read_as_the_same_organ_in_the_same_place) {
    const std::array<Eigen::Matrix3d, 4> rotations{
        Eigen::Matrix3d::Identity(), Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitX()).toRotationMatrix(),
        Eigen::AngleAxisd(-0.8, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(),
        Eigen::AngleAxisd(2.4, Eigen::Vector3d(-2, 1, 0.5).normalized()).toRotationMatrix()};
    const LabelMap expected = organ(rotations[static_cast<std::size_t>(GetParam())]);
    const sample::Scratch folder;
    std::array<int, 3> order{0, 1, 2};
    int orders = 0;
    do {
        for (unsigned backwards = 0; backwards < 8; ++backwards, ++orders) {
            const LabelMap map = stored_along(expected, order, backwards);
            const std::string shorts = test::raw_bytes<std::uint16_t>(map.labels);
            const std::vector<float> real(map.labels.begin(), map.labels.end());
            test::write_bytes(folder / "lps.nrrd",
                              test::nrrd_file(map.grid, "ushort", shorts, "left-posterior-superior"));
            test::write_bytes(folder / "ras.nrrd",
                              test::nrrd_file(map.grid, "ushort", shorts, "right-anterior-superior"));
            test::write_bytes(folder / "o.mha", test::meta_file(map.grid, "MET_USHORT", shorts));
            test::write_bytes(folder / "o.nii", test::nifti_file(map.grid, test::raw_bytes<float>(real)));
            test::write_bytes(folder / "o.vti", vti_file(map));
            write_label_map(folder / "o.seg.nrrd", map);
            write_nifti_labels(folder / "o.nii.gz", map);
            for (const char* name :
                 {"lps.nrrd", "ras.nrrd", "o.mha", "o.nii", "o.vti", "o.seg.nrrd", "o.nii.gz"}) {
                SCOPED_TRACE(fmt::format("{} along {} {} {}, backwards {}", name, order[0], order[1],
                                         order[2], backwards));
                expect_same_organ(read_label_map(folder / name), expected);
            }
            std::filesystem::create_directories(folder / "dicom");
            const std::vector<std::int16_t> stored(map.labels.begin(), map.labels.end());
            const auto plane = static_cast<std::size_t>(map.grid.size[0] * map.grid.size[1]);
            for (int k = 0; k < map.grid.size[2]; ++k)
                test::write_bytes(
                    folder / fmt::format("dicom/{}", k),
                    test::ct_slice(map.grid, map.grid.point_of({0, 0, 1.0 * k}),
                                   std::span(stored).subspan(static_cast<std::size_t>(k) * plane, plane))
                        .file());
            SCOPED_TRACE(
                fmt::format("DICOM along {} {} {}, backwards {}", order[0], order[1], order[2], backwards));
            expect_same_organ(as_labels(read_volume(folder / "dicom")), expected);
            std::filesystem::remove_all(folder / "dicom");
            if (HasFatalFailure()) return;
        }
    } while (std::ranges::next_permutation(order).found);
    EXPECT_EQ(orders, 48);
}

INSTANTIATE_TEST_SUITE_P(Rotations, Orientation, ::testing::Range(0, 4));

}  // namespace
}  // namespace palpate
