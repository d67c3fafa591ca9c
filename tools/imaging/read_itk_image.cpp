// SPDX-License-Identifier: GPL-3.0-or-later
// NRRD and MetaImage, through ITK.
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fstream>
#include <itkMetaDataObject.h>
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>
#include <sstream>

#include "formats/model/errors.hpp"
#include "tools/imaging/itk_image.hpp"
#include "tools/imaging/read_image.hpp"

namespace palpate {
namespace {

itk::ImageIOBase::Pointer image_io_of(const std::filesystem::path& path) {
    const std::array<itk::ImageIOBase::Pointer, 2> candidates{itk::NrrdImageIO::New().GetPointer(),
                                                              itk::MetaImageIO::New().GetPointer()};
    for (const auto& io : candidates)
        if (io->CanReadFile(path.c_str())) return io;
    if (path.extension() == ".hdr" || path.extension() == ".img")
        throw InvalidInput({path.string(), "is one half of an Analyze or NIfTI pair",
                            "one file that says which way the patient lies", "convert it to .nii.gz"});
    throw InvalidInput({path.string(), "is not a volume",
                        "NRRD, MetaImage, NIfTI, VTK image data or a DICOM folder",
                        "check that the file is whole and its ending names its format"});
}

ImageGrid grid_of(const itk::ImageIOBase& io, const std::filesystem::path& path) {
    unsigned axes = 0;
    for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis)
        if (axis < 3 || io.GetDimensions(axis) > 1) ++axes;
    if (axes != 3)
        throw InvalidInput({path.string(), fmt::format("has {} dimensions", axes), "3",
                            "export one three-dimensional volume"});
    ImageGrid grid;
    std::array<std::int64_t, 3> size{};
    for (unsigned axis = 0; axis < 3; ++axis) {
        size[axis] = static_cast<std::int64_t>(io.GetDimensions(axis));
        grid.spacing[axis] = io.GetSpacing(axis);
        grid.origin[axis] = io.GetOrigin(axis);
        const std::vector<double> direction = io.GetDirection(axis);
        for (unsigned row = 0; row < 3; ++row) grid.direction(row, axis) = direction[row];
    }
    check_size(size, path);
    std::ranges::transform(size, grid.size.begin(), [](auto n) { return static_cast<std::int32_t>(n); });
    return grid;
}

std::map<std::string, std::string> header_of(const itk::MetaDataDictionary& dictionary) {
    std::map<std::string, std::string> header;
    for (const std::string& key : dictionary.GetKeys())
        if (std::string text; itk::ExposeMetaData(dictionary, key, text)) header[key] = text;
    return header;
}

// Whether a MetaImage's data file is as long as its header says.
bool meta_data_is_long_enough(const std::filesystem::path& path, std::size_t bytes) {
    std::ifstream stream(path, std::ios::binary);
    std::string line;
    while (std::getline(stream, line)) {
        std::istringstream words(line);
        std::string key, equals, value;
        words >> key >> equals >> value;
        if (key == "CompressedData" && (value.starts_with("T") || value.starts_with("t"))) bytes = 1;
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

template <typename Voxel>
std::vector<Voxel> read_voxels(itk::ImageIOBase& io, std::size_t count, bool twice) {
    std::vector<Voxel> voxels(count);
    io.Read(voxels.data());
    if (!twice) return voxels;
    // ITK's MetaImage reader says nothing where decompression fails; what it leaves unread keeps what was
    // there.
    std::vector<Voxel> again(count);
    std::ranges::fill(std::as_writable_bytes(std::span(again)), std::byte{0xff});
    io.Read(again.data());
    const auto bytes = std::as_bytes(std::span(voxels)), bytes_again = std::as_bytes(std::span(again));
    if (!std::ranges::equal(bytes, bytes_again)) voxels.clear();
    return voxels;
}

StoredVoxels read_voxels(itk::ImageIOBase& io, std::size_t count, bool twice) {
    using enum itk::IOComponentEnum;
    switch (io.GetComponentType()) {
        case UCHAR:
            return read_voxels<std::uint8_t>(io, count, twice);
        case CHAR:
            return read_voxels<std::int8_t>(io, count, twice);
        case USHORT:
            return read_voxels<std::uint16_t>(io, count, twice);
        case SHORT:
            return read_voxels<std::int16_t>(io, count, twice);
        case UINT:
            return read_voxels<std::uint32_t>(io, count, twice);
        case INT:
            return read_voxels<std::int32_t>(io, count, twice);
        case ULONG:
        case ULONGLONG:
            return read_voxels<std::uint64_t>(io, count, twice);
        case LONG:
        case LONGLONG:
            return read_voxels<std::int64_t>(io, count, twice);
        case FLOAT:
            return read_voxels<float>(io, count, twice);
        case DOUBLE:
            return read_voxels<double>(io, count, twice);
        default:
            return {};
    }
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

StoredImage read_itk_image(const std::filesystem::path& path, const NoteSink& note) {
    const itk::ImageIOBase::Pointer io = image_io_of(path);
    const bool meta = dynamic_cast<itk::MetaImageIO*>(io.GetPointer()) != nullptr;
    try {
        io->SetFileName(path.string());
        io->ReadImageInformation();
        StoredImage image;
        image.grid = grid_of(*io, path);
        image.layers = io->GetNumberOfComponents();
        image.header = header_of(io->GetMetaDataDictionary());
        check_geometry(image.grid, path, note);
        if (note && !meta && !image.header.contains("NRRD_space"))
            note("the header names no patient space; taken as LPS");
        const std::size_t count = image.layers * image.grid.voxel_count();
        const auto bytes = static_cast<std::size_t>(io->GetImageSizeInBytes());
        itk::ImageIORegion whole(io->GetNumberOfDimensions());
        for (unsigned axis = 0; axis < io->GetNumberOfDimensions(); ++axis)
            whole.SetSize(axis, io->GetDimensions(axis));
        io->SetIORegion(whole);
        if (!meta || meta_data_is_long_enough(path, bytes)) image.voxels = read_voxels(*io, count, meta);
        if (std::visit([](const auto& voxels) { return voxels.empty(); }, image.voxels))
            throw InvalidInput({path.string(), "holds fewer voxels than its header claims", "",
                                "check that the file is whole"});
        return image;
    } catch (const itk::ExceptionObject& error) {
        throw InvalidInput(
            {path.string(), "cannot be read: " + reason_of(error), "", "check that the file is whole"});
    }
}

}  // namespace palpate
