// SPDX-License-Identifier: GPL-3.0-or-later
// Corners of NRRD, MetaImage and VTK files that strangers meet.
#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <span>
#include <zlib.h>

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

// Voxels of three segments: 'organ' and 'lesion' overlap in layer 0 and 1, 'vessel' shares a layer and does
// not.
std::string layered_segmentation(bool overlap) {
    std::vector<std::uint8_t> voxels(2 * 4 * 5 * 6, 0);
    for (std::size_t n = 10; n < 40; ++n) voxels[2 * n] = 1;                     // organ: 30 voxels
    for (std::size_t n = 60; n < 65; ++n) voxels[2 * n] = 2;                     // vessel: 5
    for (std::size_t n = overlap ? 38 : 40; n < 44; ++n) voxels[2 * n + 1] = 1;  // lesion: 6 or 4
    return "NRRD0004\ntype: unsigned char\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 4 5 6\n"
           "space directions: none (0.5,0,0) (0,0.75,0) (0,0,1.25)\nkinds: list domain domain domain\n"
           "encoding: raw\nspace origin: (1,2,3)\n"
           "Segment0_ID:=a\nSegment0_Name:=lesion\nSegment0_LabelValue:=1\nSegment0_Layer:=1\nSegment0_Color:"
           "=1 0 0\n"
           "Segment1_ID:=b\nSegment1_Name:=organ\nSegment1_LabelValue:=1\nSegment1_Layer:=0\n"
           "Segment2_ID:=c\nSegment2_Name:=vessel\nSegment2_LabelValue:=2\nSegment2_Layer:=0\n\n" +
           test::raw_bytes<std::uint8_t>(voxels);
}

std::size_t voxels_of(const LabelMap& map, const std::string& name) {
    const Label label = require_label(map, name, "map");
    return static_cast<std::size_t>(std::ranges::count(map.labels, label.value));
}

TEST(SegNrrd, layers_that_do_not_overlap_become_one_map_with_names_and_colours) {
    const Scratch folder;
    write_bytes(folder / "s.seg.nrrd", layered_segmentation(false));
    const LabelMap map = read_label_map(folder / "s.seg.nrrd");
    EXPECT_EQ(map.grid.size, (std::array<std::int32_t, 3>{4, 5, 6}));
    ASSERT_EQ(map.names.size(), 3U);
    EXPECT_EQ(voxels_of(map, "organ"), 30U);
    EXPECT_EQ(voxels_of(map, "vessel"), 5U);
    EXPECT_EQ(voxels_of(map, "lesion"), 4U);
    EXPECT_EQ(require_label(map, "lesion", "").colour, (std::array<float, 3>{1, 0, 0}));
}

TEST(SegNrrd, overlaps_are_refused_with_the_pair_or_decided_as_asked) {
    const Scratch folder;
    write_bytes(folder / "s.seg.nrrd", layered_segmentation(true));
    try {
        read_label_map(folder / "s.seg.nrrd");
        FAIL() << "was read";
    } catch (const InvalidInput& error) {
        EXPECT_SAYS(std::string(error.what()), "'lesion' and 'organ' both claim 2 voxels");
    }
    ReadOptions options;
    std::string notes;
    options.overlaps = Overlaps::later_wins;
    LabelMap map = read_label_map(
        folder / "s.seg.nrrd", [&](std::string_view note) { notes += note; }, options);
    EXPECT_EQ(voxels_of(map, "organ"), 30U);
    EXPECT_EQ(voxels_of(map, "lesion"), 4U);
    EXPECT_SAYS(notes, "the later one got them");
    options.overlaps = Overlaps::smaller_wins;
    map = read_label_map(folder / "s.seg.nrrd", {}, options);
    EXPECT_EQ(voxels_of(map, "organ"), 28U);
    EXPECT_EQ(voxels_of(map, "lesion"), 6U);
}

TEST(SegNrrd, old_segmentations_hold_a_segment_in_each_layer) {
    const Scratch folder;
    std::string file = layered_segmentation(false);
    for (const char* field :
         {"Segment0_LabelValue:=1\nSegment0_Layer:=1\n", "Segment1_LabelValue:=1\nSegment1_Layer:=0\n",
          "Segment2_ID:=c\nSegment2_Name:=vessel\nSegment2_LabelValue:=2\nSegment2_Layer:=0\n"})
        file.erase(file.find(field), std::strlen(field));
    // Layer 0 of the voxels is now the first segment, 'lesion'; without the vessel's value 2.
    for (char& voxel : std::span(file).last(240))
        if (voxel == 2) voxel = 0;
    write_bytes(folder / "s.seg.nrrd", file);
    const LabelMap map = read_label_map(folder / "s.seg.nrrd");
    EXPECT_EQ(voxels_of(map, "lesion"), 30U);
    EXPECT_EQ(voxels_of(map, "organ"), 4U);
}

TEST(Nrrd, every_patient_space_becomes_lps_and_others_are_noted) {
    const Scratch folder;
    const std::vector<std::int16_t> voxels{1, 2, 3, 4, 5, 6, 7, 8};
    for (const auto& [space, sign] :
         std::map<std::string, Eigen::Vector3d>{{"left-posterior-superior", {1, 1, 1}},
                                                {"LPS", {1, 1, 1}},
                                                {"right-anterior-superior", {-1, -1, 1}},
                                                {"RAS", {-1, -1, 1}},
                                                {"left-anterior-superior", {1, -1, 1}},
                                                {"LAS", {1, -1, 1}},
                                                {"las", {1, -1, 1}},
                                                {"ras", {-1, -1, 1}},
                                                {"Left-Anterior-Superior", {1, -1, 1}},
                                                {"scanner-xyz", {1, 1, 1}}}) {
        SCOPED_TRACE(space);
        write_bytes(folder / "v.nrrd",
                    "NRRD0004\ntype: short\ndimension: 3\nspace: " + space +
                        "\nsizes: 2 2 2\nspace directions: (0,2,0) (3,0,0) (0,0,-4)\nendian: little\n"
                        "encoding: raw\nspace origin: (10,20,30)\n\n" +
                        test::raw_bytes<std::int16_t>(voxels));
        std::string notes;
        const Volume volume = read_volume(folder / "v.nrrd", [&](std::string_view note) { notes += note; });
        EXPECT_LT((volume.grid.point_of({1, 0, 0}) - sign.cwiseProduct(Eigen::Vector3d(10, 22, 30))).norm(),
                  1e-9);
        EXPECT_LT((volume.grid.point_of({0, 1, 0}) - sign.cwiseProduct(Eigen::Vector3d(13, 20, 30))).norm(),
                  1e-9);
        EXPECT_LT((volume.grid.point_of({0, 0, 1}) - sign.cwiseProduct(Eigen::Vector3d(10, 20, 26))).norm(),
                  1e-9);
        EXPECT_EQ(notes.empty(), space != "scanner-xyz") << notes;
    }
}

TEST(Nrrd, without_a_voxel_size_is_taken_as_1_mm_and_says_so) {
    const Scratch folder;
    const std::vector<std::int16_t> voxels{1, 2, 3, 4, 5, 6, 7, 8};
    for (const auto& [field, said] : {std::pair("", true), std::pair("spacings: 2 2 2\n", false)}) {
        write_bytes(folder / "v.nrrd", std::string("NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\n") +
                                           field + "endian: little\nencoding: raw\n\n" +
                                           test::raw_bytes<std::int16_t>(voxels));
        std::string notes;
        const Volume volume = read_volume(folder / "v.nrrd", [&](std::string_view note) { notes += note; });
        EXPECT_EQ(volume.grid.spacing[0], said ? 1 : 2);
        EXPECT_EQ(notes.find("names no voxel size; taken as 1 mm") != std::string::npos, said) << notes;
    }
}

TEST(Nrrd, units_other_than_millimetres_are_refused_by_name) {
    const Scratch folder;
    const Volume volume = oblique_ramp();
    const auto file = [&](const std::string& units) {
        return test::nrrd_file(volume.grid, "float", test::raw_bytes<float>(volume.values),
                               "left-posterior-superior", "space units: " + units + "\n");
    };
    write_bytes(folder / "v.nrrd", file("\"mm\" \"mm\" \"mm\""));
    EXPECT_EQ(read_volume(folder / "v.nrrd").values, volume.values);
    write_bytes(folder / "v.nrrd", file("\"mm\" \"mm\" \"m\""));
    EXPECT_SAYS(test::volume_refusal<Error>(folder / "v.nrrd"), "space units \"mm\" \"mm\" \"m\"");
}

TEST(Claims, of_more_voxels_than_a_file_can_hold_are_refused_before_memory_is_taken) {
    const Scratch folder;
    ImageGrid grid = oblique_ramp().grid;
    grid.size = {60000, 60000, 60000};  // 432 TB of int16
    const std::string data(1000, '\1');
    std::string packed = test::nrrd_file(grid, "short", data, "left-posterior-superior");
    packed.replace(packed.find("raw"), 3, "gzip");
    std::string meta = test::meta_file(grid, "MET_SHORT", data);
    std::map<std::string, std::string> files{
        {"v.nrrd", test::nrrd_file(grid, "short", data, "left-posterior-superior")},
        {"packed.nrrd", packed},
        {"v.mha", meta},
        {"packed.mha", meta.insert(meta.find("ElementData"), "CompressedData = True\n")},
        {"v.vti",
         "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 59999 0 59999 0 59999\" Origin=\"0 0 0\" "
         "Spacing=\"1 1 1\"><Piece Extent=\"0 59999 0 59999 0 59999\"><PointData><DataArray type=\"Int16\" "
         "Name=\"a\" format=\"ascii\">1 2 3</DataArray></PointData></Piece></ImageData></VTKFile>"},
        {"v.vtk",
         "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 60000 60000 60000\n"
         "ORIGIN 1 2 3\nSPACING 1 1 1\nPOINT_DATA 216000000000000\nSCALARS s short 1\n"
         "LOOKUP_TABLE default\n1 2 3\n"}};
    for (const auto& [name, file] : files) {
        write_bytes(folder / name, file);
        EXPECT_SAYS(test::volume_refusal<Error>(folder / name),
                    name + ": holds fewer voxels than its header claims");
    }
}

TEST(ReadVolume, endings_do_not_depend_on_case) {
    const Scratch folder;
    const Volume volume = oblique_ramp();
    write_bytes(folder / "V.NII", test::nifti_file(volume.grid, test::raw_bytes<float>(volume.values)));
    write_bytes(folder / "V.MHA",
                test::meta_file(volume.grid, "MET_FLOAT", test::raw_bytes<float>(volume.values)));
    write_bytes(folder / "V.NRRD",
                test::nrrd_file(volume.grid, "float", test::raw_bytes<float>(volume.values),
                                "left-posterior-superior"));
    for (const char* name : {"V.NII", "V.MHA", "V.NRRD"})
        EXPECT_EQ(read_volume(folder / name).values, volume.values);
}

TEST(SegNrrd, three_segments_in_one_voxel_are_three_pairs) {
    const Scratch folder;
    std::string fields;
    for (int n = 0; n < 3; ++n)
        fields += fmt::format("Segment{0}_Name:={1}\nSegment{0}_LabelValue:=1\nSegment{0}_Layer:={0}\n", n,
                              std::array{"a", "b", "c\xed\xa0\x80"}[static_cast<std::size_t>(n)]);
    std::string voxels(3 * 8, '\0');
    voxels[0] = voxels[1] = voxels[2] = voxels[3] = voxels[5] = 1;
    write_bytes(folder / "s.seg.nrrd",
                "NRRD0004\ntype: unsigned char\ndimension: 4\nspace: LPS\nsizes: 3 2 2 2\n"
                "space directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\n"
                "encoding: raw\nspace origin: (1,2,3)\n" +
                    fields + "\n" + voxels);
    ReadOptions options;
    options.overlaps = Overlaps::smaller_wins;
    std::string notes;
    const LabelMap map = read_label_map(
        folder / "s.seg.nrrd", [&](std::string_view note) { notes += note; }, options);
    EXPECT_SAYS(notes, "'a' and 'b' both claim 1 voxels");
    EXPECT_SAYS(notes, "'a' and 'c\xc3\xad\xc2\xa0\xc2\x80' both claim 2 voxels");  // a surrogate is no UTF-8
    EXPECT_SAYS(notes, "'b' and 'c");
    EXPECT_EQ(map.labels[0], 2);  // 'b' has one voxel
}

TEST(SegNrrd, a_segment_without_name_is_called_by_its_value) {
    const Scratch folder;
    std::string file = layered_segmentation(false);
    file.replace(file.find("Name:=vessel"), 12, "Name:=");
    write_bytes(folder / "s.seg.nrrd", file);
    EXPECT_EQ(voxels_of(read_label_map(folder / "s.seg.nrrd"), "label_2"), 5U);
}

TEST(LabelValues, up_to_65535_are_exact_and_beyond_are_refused) {
    const Scratch folder;
    const ImageGrid grid = oblique_ramp().grid;
    std::vector<std::uint32_t> values(grid.voxel_count(), 0);
    values[3] = 65535;
    values[4] = 65534;
    const auto file = [&] {
        return test::nrrd_file(grid, "uint", test::raw_bytes<std::uint32_t>(values),
                               "left-posterior-superior");
    };
    write_bytes(folder / "l.nrrd", file());
    const LabelMap map = read_label_map(folder / "l.nrrd");
    EXPECT_EQ(map.labels[3], 65535);
    EXPECT_EQ(map.labels[4], 65534);
    values[5] = 65536;
    write_bytes(folder / "l.nrrd", file());
    EXPECT_THROW(read_label_map(folder / "l.nrrd"), InvalidInput);
}

std::string deflated(const std::string& bytes) {
    uLongf size = compressBound(bytes.size());
    std::string packed(size, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
             bytes.size());
    return packed.substr(0, size);
}

TEST(MetaImage, compressed_data_is_read_with_and_without_its_size_and_not_if_cut) {
    const Scratch folder;
    const Volume volume = oblique_ramp();
    const std::string packed = deflated(test::raw_bytes<float>(volume.values));
    std::string header = test::meta_file(volume.grid, "MET_FLOAT", "");
    const auto end = header.find("ElementDataFile");
    for (const bool sized : {true, false})
        for (const bool local : {true, false}) {
            SCOPED_TRACE(fmt::format("sized {}, local {}", sized, local));
            const std::string text = header.substr(0, end) + "CompressedData = True\n" +
                                     (sized ? fmt::format("CompressedDataSize = {}\n", packed.size()) : "") +
                                     (local ? "ElementDataFile = LOCAL\n" : "ElementDataFile = v.zraw\n");
            const auto path = folder / (local ? "v.mha" : "v.mhd");
            const auto write = [&](const std::string& data) {
                write_bytes(path, local ? text + data : text);
                if (!local) write_bytes(folder / "v.zraw", data);
            };
            write(packed);
            const Volume read = read_volume(path);
            expect_same_place(read.grid, volume.grid);
            EXPECT_EQ(read.values, volume.values);
            write(packed.substr(0, packed.size() / 2));
            EXPECT_THROW(read_volume(path), InvalidInput);
        }
}

TEST(MetaImage, slope_blanks_and_header_sizes_are_honoured_and_lists_of_files_refused) {
    const Scratch folder;
    const Volume volume = oblique_ramp();
    const std::string raw = test::raw_bytes<float>(volume.values), skipped(100, 'H');
    const auto read = [&](const std::string& fields, const std::string& file) {
        std::string header = test::meta_file(volume.grid, "MET_FLOAT", "");
        header.replace(header.find("ElementDataFile"), std::string::npos,
                       fields + "ElementDataFile = " + file + "\n");
        write_bytes(folder / "v.mhd", header);
        return read_volume(folder / "v.mhd").values;
    };
    write_bytes(folder / "my scan.raw", raw);
    EXPECT_EQ(read("", "my scan.raw"), volume.values);
    EXPECT_EQ(read("ElementToIntensityFunctionSlope = 2\nElementToIntensityFunctionOffset = -5\n",
                   "my scan.raw")[3],
              2 * volume.values[3] - 5);
    write_bytes(folder / "h.raw", skipped + raw);
    EXPECT_EQ(read("HeaderSize = 100\n", "h.raw"), volume.values);
    EXPECT_EQ(read("HeaderSize = -1\n", "h.raw"), volume.values);
    write_bytes(folder / "h.zraw", skipped + deflated(raw));
    EXPECT_EQ(read("HeaderSize = 100\nCompressedData=True\n", "h.zraw"), volume.values);
    for (const char* several : {"LIST\na.raw\nb.raw", "s%02d.raw 0 5 1"}) {
        EXPECT_THROW(read("", several), InvalidInput);
        EXPECT_SAYS(test::volume_refusal<Error>(folder / "v.mhd"), "voxels in several files");
    }
}

TEST(VtkImage, legacy_structured_points_are_read_and_other_data_refused) {
    const Scratch folder;
    const std::string header =
        "# vtk DataFile Version 3.0\nJane Roe\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 3 2\n"
        "ORIGIN 1 2 3\nSPACING 0.5 0.75 1.25\nPOINT_DATA 12\nSCALARS s short 1\nLOOKUP_TABLE default\n";
    write_bytes(folder / "v.vtk", header + "1 2 3 4 5 6 7 8 9 10 11 12\n");
    std::string notes;
    const Volume volume = read_volume(folder / "v.vtk", [&](std::string_view note) { notes += note; });
    EXPECT_EQ(volume.grid.size, (std::array<std::int32_t, 3>{2, 3, 2}));
    EXPECT_EQ(volume.grid.origin, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(volume.grid.spacing, Eigen::Vector3d(0.5, 0.75, 1.25));
    EXPECT_EQ(volume.values.front(), 1);
    EXPECT_EQ(volume.values.back(), 12);
    EXPECT_SAYS(notes, "taken as LPS");
    write_bytes(folder / "v.vtk", header + "1 2 3\n");
    EXPECT_THROW(read_volume(folder / "v.vtk"), InvalidInput);
    write_bytes(folder / "v.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 0 float\n");
    EXPECT_THROW(read_volume(folder / "v.vtk"), InvalidInput);
    write_bytes(folder / "v.vti", "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1 0 1 0 1\">");
    EXPECT_THROW(read_volume(folder / "v.vti"), InvalidInput);
}

}  // namespace
}  // namespace palpate
