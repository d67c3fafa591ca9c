// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <sys/stat.h>
#include <vector>

#include "tests/formats/scratch.hpp"
#include "tests/tools/imaging/hand_written_images.hpp"
#include "tests/tools/imaging/refusals.hpp"

namespace palpate {
namespace {

using sample::Scratch;
using test::write_bytes;

TEST(ReadVolume, what_is_no_volume_is_called_so_however_large_its_lines_are) {
    const Scratch folder;
    const std::string binary = std::string(3 << 20, '\x7f') + std::string(20000, '\n');
    for (const char* name : {"scan.img", "scan.hdr"}) {
        write_bytes(folder / name, binary);
        EXPECT_SAYS(test::volume_refusal(folder / name), "is one half of an Analyze or NIfTI pair");
    }
    for (const auto& [name, start] : std::map<std::string, std::string>{
             {"report.pdf", "%PDF-1.4\n"}, {"photo.jpg", "\xff\xd8\xff\xe0"}, {"scan.mha", "\xff\xd8"}}) {
        write_bytes(folder / name, start + binary);
        EXPECT_SAYS(test::volume_refusal(folder / name), "is not a volume") << name;
    }
    for (const auto& [name, start] : std::map<std::string, std::string>{
             {"v.nrrd", "NRRD0004\n#"}, {"v.mha", "NDims = 3\nComment = "}, {"w.mha", "NDims = 3 "}}) {
        write_bytes(folder / name, start + std::string(3 << 20, ' ') + "x");
        EXPECT_SAYS(test::volume_refusal(folder / name), "more than 8192 lines or 1 MiB") << name;
    }
}

// Reading them would have no end.
TEST(ReadVolume, voxels_in_pipes_or_the_standard_input_are_refused) {
    const Scratch folder;
    ASSERT_EQ(mkfifo((folder / "slice007.raw").c_str(), 0600), 0);
    write_bytes(folder / "slice001.raw", "voxels");
    for (const std::string file :
         {"-", "slice007.raw", "slice%03d.raw 1 9 2", "slice%03d.raw 9 1 -2",
          "LIST\nslice001.raw\nslice007.raw", "LIST 2\nslice001.raw\n\nslice007.raw"}) {
        write_bytes(folder / "v.nhdr",
                    "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: " + file);
        EXPECT_SAYS(test::volume_refusal(folder / "v.nhdr"), "keeps its voxels in what is no file") << file;
    }
    for (const std::string file : {"slice%c.raw 1 9 1", "slice%d%d.raw 1 9 1", "slice%333d.raw 1 9 1"}) {
        write_bytes(folder / "v.nhdr",
                    "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\ndata file: " + file);
        EXPECT_SAYS(test::volume_refusal(folder / "v.nhdr"), "by a pattern of another kind") << file;
    }
}

TEST(ReadVolume, pipes_and_devices_are_called_so) {
    const Scratch folder;
    const std::string pipe = folder / "scan.nrrd";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    for (const auto& [path, found] : {std::pair(pipe, "is a pipe"), {"/dev/zero", "is a device"}}) {
        EXPECT_FALSE(imaging::is_dicom(path));
        EXPECT_SAYS(test::volume_refusal(path), found);
        EXPECT_SAYS(test::refusal_of([&] { imaging::read_image(path); }), found);
        EXPECT_SAYS(test::refusal_of([&] { imaging::read_label_map(path); }), found);
        EXPECT_SAYS(test::refusal_of([&] { imaging::list_series(path); }), found);
    }
}

// Nobody's header may turn other files of a machine into voxels.
TEST(ReadVolume, voxels_outside_the_headers_folder_are_refused) {
    const Scratch folder;
    std::filesystem::create_directories(folder / "in/raw");
    for (const char* file : {"out.raw", "in/raw/v.raw", "in/v.raw"}) write_bytes(folder / file, "abcdefgh");
    const std::string nrrd = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: ";
    const std::string meta =
        "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = ";
    const auto refusals = [&](const std::string& file) {
        write_bytes(folder / "in/v.nhdr", nrrd + file + "\n");
        write_bytes(folder / "in/v.mhd", meta + file + "\n");
        return test::volume_refusal(folder / "in/v.nhdr") + test::volume_refusal(folder / "in/v.mhd");
    };
    const std::string outside = "keeps its voxels outside its own folder";
    for (const std::string& file : std::vector<std::string>{"/etc/passwd", "../out.raw", "raw/../../out.raw",
                                                            (folder / "out.raw").string()}) {
        const std::string said = refusals(file);
        EXPECT_NE(said.find(outside), said.rfind(outside)) << file << said;
    }
    for (const std::string& file : std::vector<std::string>{"v.raw", "./v.raw", "raw/v.raw", "raw/../v.raw",
                                                            (folder / "in/v.raw").string()})
        EXPECT_EQ(refusals(file), "nothing was refusednothing was refused") << file;
    write_bytes(folder / "in/v.nhdr", nrrd + "LIST\n../out.raw\n");
    EXPECT_SAYS(test::volume_refusal(folder / "in/v.nhdr"), outside);
    write_bytes(folder / "in/v.nhdr", nrrd + "../slice%03d.raw 1 2 1\n");
    EXPECT_SAYS(test::volume_refusal(folder / "in/v.nhdr"), outside);
}

// NrrdIO and MetaIO take the beginning of what is no whole number, and letters for numbers.
TEST(ReadVolume, fields_that_are_not_of_whole_numbers_are_refused) {
    const Scratch folder;
    const std::string voxels(100, 'v');
    for (const std::string sizes : {"4.5 4 4", "1e3 2 2", "2 2 -2", "0x2 2 2"}) {
        write_bytes(folder / "v.nrrd",
                    "NRRD0004\ntype: uchar\ndimension: 3\nsizes: " + sizes + "\nencoding: raw\n\n" + voxels);
        EXPECT_SAYS(test::volume_refusal(folder / "v.nrrd"),
                    "has sizes '" + sizes + "' (expected whole numbers)");
        write_bytes(folder / "v.mha", "ObjectType = Image\nNDims = 3\nDimSize = " + sizes +
                                          "\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + voxels);
        EXPECT_SAYS(test::volume_refusal(folder / "v.mha"),
                    "has DimSize '" + sizes + "' (expected whole numbers)");
    }
    for (const std::string type : {"MET_STRING", "MET_NONE", "MET_FLOAT_ARRAY"}) {
        write_bytes(folder / "v.mha", "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = " +
                                          type + "\nElementDataFile = LOCAL\n" + voxels);
        EXPECT_SAYS(test::volume_refusal(folder / "v.mha"), "has ElementType '" + type + "'");
    }
    for (const std::string field :
         {"Segment0_LabelValue:=1.5", "Segment0_LabelValue:=1\nSegment0_Layer:=0.5"}) {
        write_bytes(
            folder / "v.seg.nrrd",
            "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nSegment0_Name:=liver\n" +
                field + "\n\n" + std::string(8, '\1'));
        EXPECT_SAYS(test::refusal_of([&] { imaging::read_label_map(folder / "v.seg.nrrd"); }),
                    field.substr(field.rfind("Segment"), 14))
            << field;
    }
}

TEST(ReadVolume, texts_that_metaio_has_no_room_for_are_refused) {
    const Scratch folder;
    const std::string begin = "ObjectType = Image\nNDims = 3\n", text(255, 'a');
    const std::string end = "\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
    for (const std::string& line :
         {text + " = 1", "Comment = " + text, "  ObjectSubType : " + text, "AcquisitionDate = " + text}) {
        write_bytes(folder / "v.mha", begin + line + end + "12345678");
        EXPECT_SAYS(test::volume_refusal(folder / "v.mha"), "of more than 254 characters") << line;
    }
    // MetaIO takes each of these for a comment or a name of its own.
    for (const std::string& line :
         {"Comment\n\n= " + text, "Comment\nFoo = " + text, "\fComment\t: " + text, "Comment\rFoo = " + text,
          "Comment" + std::string(1, '\0') + "Foo = " + text, "Foo\nElementDataFile = x\nComment = " + text,
          "ElementDataFiles = x\nComment = " + text, text}) {
        write_bytes(folder / "v.mha", begin + line + end + "12345678");
        EXPECT_SAYS(test::volume_refusal(folder / "v.mha"), "of more than 254 characters") << line;
    }
    // And has room for these, such as a text of several lines out of DICOM.
    for (const std::string& line :
         {"Comment = " + text.substr(1), std::string("0020|4000 = one\r\ntwo\n0020|0010 = 3"),
          "0020|4000 = \x1b$B" + text, "Foo\nComment = " + text, "= " + text}) {
        write_bytes(folder / "v.mha", begin + line + end + "12345678");
        EXPECT_EQ(test::volume_refusal(folder / "v.mha"), "nothing was refused") << line;
    }
}

}  // namespace
}  // namespace palpate
