// SPDX-License-Identifier: GPL-3.0-or-later
// What GDCM and DCMTK must not see.
#include <gtest/gtest.h>

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
using test::slice_of_two;

constexpr std::uint32_t protocol_codes = 0x00400260;

// The series with the first file changed.
std::string first_file_refusal(const std::function<std::string(std::string)>& changed) {
    const Scratch folder;
    test::write_bytes(folder / "0.dcm", changed(slice_of_two(0).file()));
    test::write_bytes(folder / "1.dcm", slice_of_two(1).file());
    return test::volume_refusal(folder.path());
}

std::string with(std::string bytes, std::size_t at, const std::string& others) {
    return bytes.replace(at, others.size(), others);
}

// Sequences of undefined length in each other, before the place of a slice.
std::string nested(int levels, const std::string& file) {
    const std::string open = std::string("\x40\x00\x60\x02SQ\0\0\xff\xff\xff\xff", 12) +
                             std::string("\xfe\xff\x00\xe0\xff\xff\xff\xff", 8),
                      close = std::string("\xfe\xff\x0d\xe0\0\0\0\0", 8) +
                              std::string("\xfe\xff\xdd\xe0\0\0\0\0", 8);
    std::string all;
    for (int n = 0; n < levels; ++n) all += open;
    for (int n = 0; n < levels; ++n) all += close;
    const std::size_t pixels = file.find(std::string("\xe0\x7f\x10\x00", 4));
    return file.substr(0, pixels) + all + file.substr(pixels);
}

TEST(DicomStructure, every_way_to_write_elements_reads_as_the_same_values) {
    const Scratch plain;
    for (const int k : {0, 1}) test::write_bytes(plain / std::to_string(k), slice_of_two(k).file());
    const Volume expected = read_volume(plain.path());
    for (const auto syntax :
         {gdcm::TransferSyntax::ImplicitVRLittleEndian, gdcm::TransferSyntax::ExplicitVRBigEndian,
          gdcm::TransferSyntax::DeflatedExplicitVRLittleEndian}) {
        SCOPED_TRACE(gdcm::TransferSyntax::GetTSString(syntax));
        const Scratch other;
        for (const char* name : {"0", "1"})
            test::write_bytes(other / name, test::transcoded(test::bytes_of(plain / name), syntax));
        const Volume volume = read_volume(other.path());
        EXPECT_TRUE(same_grid(volume.grid, expected.grid));
        EXPECT_EQ(volume.values, expected.values);
    }
}

TEST(DicomStructure, sequences_may_lie_32_deep_and_deeper_ones_are_refused_before_a_stack_overflows) {
    const Scratch folder;
    test::write_bytes(folder / "0.dcm", nested(32, slice_of_two(0).file()));
    test::write_bytes(folder / "1.dcm", slice_of_two(1).file());
    EXPECT_EQ(read_volume(folder.path()).values.size(), 240U);
    for (const int levels : {33, 100000})
        EXPECT_SAYS(first_file_refusal([&](const std::string& file) { return nested(levels, file); }),
                    "0.dcm: has sequences more than 32 deep")
            << levels;
}

TEST(DicomStructure, elements_of_unknown_types_and_lengths_that_do_not_fit_are_refused_by_name) {
    const auto at = [](const std::string& file, std::uint32_t tag) {
        return file.find(test::little_endian(tag >> 16, 2) + test::little_endian(tag & 0xffff, 2), 132);
    };
    EXPECT_SAYS(
        first_file_refusal([&](const std::string& f) { return with(f, at(f, 0x0020000d) + 4, "??"); }),
        "0.dcm: cannot be read, it is cut off or damaged: element (0020,000d) has a type that DICOM "
        "does not know");
    EXPECT_SAYS(
        first_file_refusal([&](const std::string& f) { return with(f, at(f, 0x7fe00010) + 10, "\x01"); }),
        "element (7fe0,0010) is longer than what holds it");
    EXPECT_SAYS(
        first_file_refusal([&](const std::string& f) { return with(f, at(f, 0x00020003) + 4, "SQ"); }),
        "element (0002,0003)");
    EXPECT_SAYS(
        first_file_refusal([&](const std::string& f) { return with(f, f.find("1.2.840.10008.1.2.1"), "9"); }),
        "transfer syntax 9.2.840.10008.1.2.1");
    const DicomData loose = slice_of_two(0).text(protocol_codes, "SQ", "no item!");
    EXPECT_SAYS(first_file_refusal([&](const std::string&) { return loose.file(); }),
                "element (0040,0260) holds what is no item");
}

TEST(DicomStructure, what_scanners_and_archives_do_though_the_standard_does_not_is_read) {
    const std::string of_later_years = std::string("\x40\x00\x01\x10ZZ\0\0\x03\0\0\0abc", 15);
    for (const auto& changed : std::vector<std::function<std::string(std::string)>>{
             [](const std::string& file) { return file + '\0'; },
             [](const std::string& file) { return file + std::string(100000, '\0'); },
             [&](const std::string& file) {
                 const std::size_t pixels = file.find(std::string("\xe0\x7f\x10\x00", 4));
                 return file.substr(0, pixels) + of_later_years + file.substr(pixels);
             }}) {
        const Scratch folder;
        test::write_bytes(folder / "0.dcm", changed(slice_of_two(0).file()));
        test::write_bytes(folder / "1.dcm", slice_of_two(1).file());
        EXPECT_EQ(read_volume(folder.path()).values.size(), 240U);
    }
    EXPECT_SAYS(first_file_refusal([](const std::string& f) { return f + std::string(9, '\0') + "x"; }),
                "0.dcm");
}

TEST(DicomStructure, several_values_a_pixel_in_grey_are_refused) {
    EXPECT_SAYS(first_file_refusal([](const std::string&) {
                    return slice_of_two(0).us(0x00280002, 2).us(0x00280010, 5).file();
                }),
                "2 samples of 16 bits");
}

TEST(DicomStructure, compressed_pixels_whose_heads_tell_another_size_are_refused_before_they_are_decoded) {
    for (const auto& [syntax, marker] : {std::pair{gdcm::TransferSyntax::JPEGLosslessProcess14_1, "\xff\xc3"},
                                         std::pair{gdcm::TransferSyntax::JPEGLSLossless, "\xff\xf7"},
                                         std::pair{gdcm::TransferSyntax::JPEG2000Lossless, "\xff\x4f"}}) {
        SCOPED_TRACE(marker);
        const Scratch plain, folder;
        for (const char* name : {"0", "1"}) {
            test::write_bytes(plain / name, slice_of_two(name[0] - '0').file());
            test::write_bytes(folder / name, test::transcoded(test::bytes_of(plain / name), syntax));
        }
        const std::string file = test::bytes_of(folder / "0");
        const std::size_t at = file.find(marker, file.find(std::string("\xe0\x7f\x10\x00", 4)));
        test::write_bytes(folder / "0", with(file, at + (marker[1] == '\x4f' ? 8 : 5), "\x7f"));
        EXPECT_SAYS(test::volume_refusal(folder.path()),
                    "compressed pixels of another kind than its header tells");
    }
}

}  // namespace
}  // namespace palpate
