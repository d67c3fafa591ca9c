// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/samples/dicom_samples.hpp"

#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>
#include <utility>

#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/tools/imaging/hand_written_dicom.hpp"
#include "tools/archive/objects/archive_objects.hpp"

namespace palpate::fuzz {
namespace {

namespace fs = std::filesystem;
using test::DicomData;

ImageGrid slices_grid() {
    ImageGrid grid;
    grid.size = {12, 10, 2};
    grid.spacing = {0.75, 0.5, 2};
    grid.origin = {-40.5, 20.25, 310};
    return grid;
}

std::vector<std::int16_t> slice_values(int k) {
    std::vector<std::int16_t> values;
    for (int n = 0; n < 120; ++n) values.push_back(static_cast<std::int16_t>(n * 37 % 101 - 50 + k));
    return values;
}

std::vector<std::string> plain_series(const ImageGrid& grid) {
    std::vector<std::string> files;
    for (int k = 0; k < grid.size[2]; ++k)
        files.push_back(
            test::ct_slice(grid, grid.point_of({0, 0, double(k)}), slice_values(k), 2, -1024).file());
    return files;
}

// Of two frames, with functional groups (PS3.3 C.7.6.16).
std::string enhanced_file(const ImageGrid& grid) {
    std::vector<std::int16_t> stored;
    std::vector<DicomData> frames;
    for (int k = 0; k < grid.size[2]; ++k) {
        std::ranges::copy(slice_values(k), std::back_inserter(stored));
        frames.push_back(
            DicomData()
                .sequence(0x00209113, {DicomData().text(0x00200032, "DS",
                                                        test::decimals(grid.point_of({0, 0, double(k)})))})
                .sequence(0x00289145, {DicomData()
                                           .text(0x00281052, "DS", "300")
                                           .text(0x00281053, "DS", test::decimals({0.01 * (k + 1)}))}));
    }
    const DicomData shared =
        DicomData()
            .sequence(0x00209116, {DicomData().text(0x00200037, "DS", test::orientation(grid))})
            .sequence(0x00289110, {DicomData().text(0x00280030, "DS", test::decimals({0.5, 0.75}))});
    return test::ct_pixels(grid, stored)
        .text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2.1")
        .text(0x00280008, "IS", "2")
        .sequence(0x52009229, {shared})
        .sequence(0x52009230, frames)
        .file();
}

// The file in another transfer syntax, by GDCM.
std::string in_syntax(const std::string& file, gdcm::TransferSyntax::TSType syntax) {
    const sample::Scratch folder;
    const std::string from = folder / "from", to = folder / "to";
    test::write_bytes(from, file);
    gdcm::ImageReader reader;
    reader.SetFileName(from.c_str());
    reader.Read();
    gdcm::ImageChangeTransferSyntax change;
    change.SetTransferSyntax(syntax);
    change.SetInput(reader.GetImage());
    change.Change();
    gdcm::ImageWriter writer;
    writer.SetFileName(to.c_str());
    writer.SetFile(reader.GetFile());
    writer.SetImage(change.GetOutput());
    writer.Write();
    return test::bytes_of(to);
}

}  // namespace

void write_dicom_samples(const fs::path& folder, const LabelMap& map) {
    fs::create_directories(folder);
    const std::vector<std::string> series = plain_series(slices_grid());
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
        write_series(name, [&](const std::string& file) { return in_syntax(file, syntax); });
    test::write_bytes(folder / "enhanced", enhanced_file(slices_grid()));
    archive::write_segmentation_object(folder / "segmentation", map, {.version = "1"}, "sample");
    archive::write_surface_object(folder / "surface", sample::sphere_surface({1, 2, 3}, 15, 0), "sphere",
                                  {.version = "1"}, "sample");
}

}  // namespace palpate::fuzz
