// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/samples/dicom_samples.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/tools/imaging/dicom/hand_written_dicom.hpp"
#include "tests/tools/imaging/dicom/transcoded_dicom.hpp"
#include "tools/archive/objects/archive_objects.hpp"

namespace palpate::fuzz {
namespace {

namespace fs = std::filesystem;

std::string enhanced_file() {
    std::vector<std::int16_t> stored;
    for (const int k : {0, 1}) std::ranges::copy(test::values_of_slice(k), std::back_inserter(stored));
    return test::enhanced_ct(test::two_slices(), stored, {0, 1}).file();
}

}  // namespace

void write_dicom_samples(const fs::path& folder, const LabelMap& map) {
    fs::create_directories(folder);
    const std::vector<std::string> series{test::slice_of_two(0).file(), test::slice_of_two(1).file()};
    const auto write_series = [&](const char* name, const auto& of_file) {
        std::string all;
        for (const std::string& file : series) all += of_file(file);
        test::write_bytes(folder / name, all);
    };
    write_series("plain", [](const std::string& file) { return file; });
    const std::vector<std::pair<const char*, gdcm::TransferSyntax::TSType>> syntaxes{
        {"implicit", gdcm::TransferSyntax::ImplicitVRLittleEndian},
        {"big_endian", gdcm::TransferSyntax::ExplicitVRBigEndian},
        {"deflated", gdcm::TransferSyntax::DeflatedExplicitVRLittleEndian},
        {"jpeg", gdcm::TransferSyntax::JPEGLosslessProcess14_1},
        {"jpegls", gdcm::TransferSyntax::JPEGLSLossless},
        {"jpeg2000", gdcm::TransferSyntax::JPEG2000Lossless},
        {"rle", gdcm::TransferSyntax::RLELossless}};
    for (const auto& [name, syntax] : syntaxes)
        write_series(name, [&](const std::string& file) { return test::transcoded(file, syntax); });
    test::write_bytes(folder / "enhanced", enhanced_file());
    archive::write_segmentation_object(folder / "segmentation", map, {.version = "1"}, "sample");
    archive::write_surface_object(folder / "surface", sample::sphere_surface({1, 2, 3}, 15, 0), "sphere",
                                  {.version = "1"}, "sample");
}

}  // namespace palpate::fuzz
