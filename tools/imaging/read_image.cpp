// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/read_image.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <itkGDCMImageIO.h>
#include <itkImageFileReader.h>
#include <itkMetaDataObject.h>
#include <itkMetaImageIO.h>
#include <itkMultiThreaderBase.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itk_zlib.h>
#include <memory>
#include <sstream>

#include "formats/model/errors.hpp"
#include "tools/imaging/itk_image.hpp"

namespace palpate {
namespace {

// Directions nearer to orthonormal than this differ by header round-off only.
constexpr double round_off_tolerance = 1e-6;
constexpr double repair_tolerance = 1e-3;

itk::ImageIOBase::Pointer image_io_of(const std::filesystem::path& path) {
    const std::array<itk::ImageIOBase::Pointer, 3> candidates{itk::NrrdImageIO::New().GetPointer(),
                                                              itk::MetaImageIO::New().GetPointer(),
                                                              itk::NiftiImageIO::New().GetPointer()};
    for (const auto& io : candidates)
        if (io->CanReadFile(path.c_str())) {
            // The other NIfTI layout and its parent Analyze do not say reliably which way the patient lies.
            if (io == candidates[2] && (path.extension() == ".hdr" || path.extension() == ".img")) break;
            return io;
        }
    if (itk::GDCMImageIO::New()->CanReadFile(path.c_str()))
        throw InvalidInput(
            {path.string(), "is a single DICOM file", "", "name the folder that holds the whole series"});
    throw InvalidInput({path.string(), "is not a volume", "NRRD, MetaImage, NIfTI or a DICOM folder",
                        "check that the file is whole and its ending names its format"});
}

// Refuses what a float volume cannot hold before any voxel is read.
void check_layout(const itk::ImageIOBase& io, const std::filesystem::path& path) {
    const std::string next = "export one scalar volume (overlapping segments: one layer)";
    if (io.GetNumberOfComponents() != 1)
        throw InvalidInput(
            {path.string(), fmt::format("has {} values per voxel", io.GetNumberOfComponents()), "1", next});
    unsigned axes = 0;
    for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis)
        if (axis < 3 || io.GetDimensions(axis) > 1) ++axes;
    if (axes != 3) throw InvalidInput({path.string(), fmt::format("has {} dimensions", axes), "3", next});
    for (unsigned axis = 0; axis < 3; ++axis)
        if (io.GetDimensions(axis) > 65535)
            throw InvalidInput({path.string(),
                                fmt::format("claims {} voxels along one axis", io.GetDimensions(axis)),
                                "65535 at most", "check that the file is whole"});
}

ImageGrid grid_of(const itk::ImageIOBase& io) {
    ImageGrid grid;
    for (unsigned axis = 0; axis < 3; ++axis) {
        grid.size[axis] = static_cast<std::int32_t>(io.GetDimensions(axis));
        grid.spacing[axis] = io.GetSpacing(axis);
        grid.origin[axis] = io.GetOrigin(axis);
        const std::vector<double> direction = io.GetDirection(axis);
        for (unsigned row = 0; row < 3; ++row) grid.direction(row, axis) = direction[row];
    }
    return grid;
}

std::map<std::string, std::string> header_of(const itk::MetaDataDictionary& dictionary) {
    std::map<std::string, std::string> header;
    for (const std::string& key : dictionary.GetKeys())
        if (std::string text; itk::ExposeMetaData(dictionary, key, text)) header[key] = text;
    return header;
}

// Bytes of a file, unpacked if it is gzip; what follows damage is not counted.
std::uint64_t readable_bytes(const std::filesystem::path& path) {
    const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
    std::vector<char> block(1 << 18);
    std::uint64_t total = 0;
    for (int count = 0; file && (count = gzread(file.get(), block.data(), 1 << 18)) > 0;)
        total += static_cast<std::uint64_t>(count);
    return total;
}

// Whether a MetaImage's data file is as long as its header says.
bool meta_data_is_long_enough(const std::filesystem::path& path, std::size_t bytes) {
    std::ifstream stream(path, std::ios::binary);
    std::string line;
    while (std::getline(stream, line)) {
        std::istringstream words(line);
        std::string key, equals, value;
        words >> key >> equals >> value;
        if (key == "CompressedDataSize") std::istringstream(value) >> bytes;
        if (key != "ElementDataFile") continue;
        std::error_code absent;
        if (value == "LOCAL")
            return std::filesystem::file_size(path) >= bytes + static_cast<std::size_t>(stream.tellg());
        const auto data_bytes = std::filesystem::file_size(path.parent_path() / value, absent);
        return !absent && data_bytes >= bytes;
    }
    return false;
}

// Reads twice over different contents: what a failed decompression leaves unread keeps what was there.
bool reads_every_byte(itk::ImageIOBase& io, std::size_t bytes) {
    itk::ImageIORegion whole(io.GetNumberOfDimensions());
    for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis)
        whole.SetSize(axis, io.GetDimensions(axis));
    io.SetIORegion(whole);
    std::vector<char> over_zeros(bytes, '\0'), over_ones(bytes, '\xff');
    io.Read(over_zeros.data());
    io.Read(over_ones.data());
    return over_zeros == over_ones;
}

// ITK's NIfTI and MetaImage readers silently fill what a short or damaged file lacks with zeros or leftovers.
bool holds_all_voxels(itk::ImageIOBase& io, const std::filesystem::path& path) {
    const auto bytes = static_cast<std::size_t>(io.GetImageSizeInBytes());
    constexpr std::size_t nifti_header_bytes = 352;
    if (dynamic_cast<itk::NiftiImageIO*>(&io) != nullptr)
        return readable_bytes(path) >= bytes + nifti_header_bytes;
    if (dynamic_cast<itk::MetaImageIO*>(&io) != nullptr)
        return meta_data_is_long_enough(path, bytes) && reads_every_byte(io, bytes);
    return true;
}

}  // namespace

std::string reason_of(const itk::ExceptionObject& error) {
    std::string text = error.GetDescription();
    if (text.starts_with("ITK ERROR: ")) text.erase(0, 11);
    if (const auto prefix = text.find("): "); prefix != std::string::npos) text.erase(0, prefix + 3);
    std::ranges::replace(text, '\n', ' ');
    while (text.ends_with(' ')) text.pop_back();
    return text.substr(0, 240);
}

void check_geometry(ImageGrid& grid, const std::filesystem::path& path, const NoteSink& note) {
    for (const std::int32_t size : grid.size)
        if (size < 2)
            throw InvalidInput({path.string(),
                                fmt::format("is empty or flat: {} x {} x {} voxels", grid.size[0],
                                            grid.size[1], grid.size[2]),
                                "2 or more along each axis", "choose the file of the whole volume"});
    if (!(grid.spacing.minCoeff() > 0) || !grid.spacing.allFinite() || !grid.origin.allFinite())
        throw InvalidInput(
            {path.string(),
             fmt::format("has spacing {} x {} x {} mm", grid.spacing[0], grid.spacing[1], grid.spacing[2]),
             "finite positive numbers", "correct the header"});
    const Eigen::Matrix3d product = grid.direction.transpose() * grid.direction;
    const double deviation = (product - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (!(deviation <= repair_tolerance))
        throw InvalidInput({path.string(), fmt::format("has directions {:.2g} off orthonormality", deviation),
                            fmt::format("{} at most", repair_tolerance),
                            "resample the volume onto a rectangular grid"});
    if (deviation <= round_off_tolerance) return;
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(grid.direction, Eigen::ComputeFullU | Eigen::ComputeFullV);
    grid.direction = svd.matrixU() * svd.matrixV().transpose();
    if (note)
        note(fmt::format("directions were {:.2g} off orthonormality and were made orthonormal", deviation));
}

void check_finite(const Volume& volume, const std::filesystem::path& path) {
    const auto bad = std::ranges::find_if(volume.values, [](float value) { return !std::isfinite(value); });
    if (bad == volume.values.end()) return;
    const auto& size = volume.grid.size;
    const auto offset = bad - volume.values.begin();
    throw InvalidInput({path.string(),
                        fmt::format("voxel ({}, {}, {}) is {}", offset % size[0], offset / size[0] % size[1],
                                    offset / size[0] / size[1], *bad),
                        "finite values", "replace such voxels, by -1024 HU in CT"});
}

ReadImage read_image_file(const std::filesystem::path& path, const NoteSink& note) {
    const itk::ImageIOBase::Pointer io = image_io_of(path);
    try {
        io->SetFileName(path.string());
        io->ReadImageInformation();
        check_layout(*io, path);
        ReadImage result;
        result.volume.grid = grid_of(*io);
        result.header = header_of(io->GetMetaDataDictionary());
        check_geometry(result.volume.grid, path, note);
        const auto space = result.header.find("NRRD_space");
        if (note && dynamic_cast<itk::NrrdImageIO*>(io.GetPointer()) != nullptr &&
            space == result.header.end())
            note("the header names no patient space; taken as LPS");
        if (!holds_all_voxels(*io, path))
            throw InvalidInput({path.string(), "holds fewer voxels than its header claims", "",
                                "check that the file is whole"});
        auto reader = itk::ImageFileReader<ItkImage<float>>::New();
        reader->SetImageIO(io);
        reader->SetFileName(path.string());
        reader->Update();
        const auto voxels = voxels_of(*reader->GetOutput());
        result.volume.values.assign(voxels.begin(), voxels.end());
        return result;
    } catch (const itk::ExceptionObject& error) {
        throw InvalidInput({path.string(), "cannot be read: " + reason_of(error), "",
                            "check that the file is whole and its directions are orthonormal"});
    }
}

Volume read_volume(const std::filesystem::path& path, const NoteSink& note) {
    itk::Object::GlobalWarningDisplayOff();
    if (!std::filesystem::exists(path))
        throw InvalidInput({path.string(), "no such file or folder", "", "check the path"});
    Volume volume = std::filesystem::is_directory(path) ? read_dicom_folder(path, note)
                                                        : read_image_file(path, note).volume;
    check_finite(volume, path);
    const auto [low, high] = std::ranges::minmax(volume.values);
    if (low == high)
        throw InvalidInput({path.string(), fmt::format("is empty: every voxel is {}", low), "",
                            "choose another file or export it again"});
    return volume;
}

void set_imaging_threads(int count) {
    itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(static_cast<itk::ThreadIdType>(count));
}

}  // namespace palpate
