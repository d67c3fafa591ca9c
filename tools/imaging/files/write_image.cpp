// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <itkImageFileWriter.h>
#include <itkMetaDataObject.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <limits>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/files/itk_image.hpp"

namespace palpate::imaging {
namespace {

// A gzip stream ends in its uncompressed size modulo 2^32, little-endian (RFC 1952 §2.3.1). Teem's writer
// does not look at the result of fclose(), so a full disk can go unnoticed by ITK.
bool ends_whole(const std::filesystem::path& path, std::uint64_t bytes) {
    std::ifstream stream(path, std::ios::binary);
    std::array<unsigned char, 4> tail{};
    stream.seekg(-4, std::ios::end);
    stream.read(reinterpret_cast<char*>(tail.data()), 4);
    std::uint32_t stored = 0;
    for (unsigned i = 0; i < 4; ++i) stored |= std::uint32_t{tail[i]} << (8 * i);
    return stream && stored == static_cast<std::uint32_t>(bytes);
}

// `before` are the bytes that the gzip stream has ahead of the voxels.
template <typename ImageIO, typename Voxel>
void write_packed(const std::filesystem::path& path, const ImageGrid& grid, std::span<const Voxel> voxels,
                  const std::map<std::string, std::string>& header, std::uint64_t before) {
    if (voxels.size() != grid.voxel_count())
        throw InvalidInput({path.string(), fmt::format("{} values", voxels.size()),
                            fmt::format("{}, one per voxel", grid.voxel_count()), ""});
    auto image = to_itk(grid, voxels);
    auto& dictionary = image->GetMetaDataDictionary();
    for (const auto& [key, text] : header) itk::EncapsulateMetaData(dictionary, key, text);
    auto writer = itk::ImageFileWriter<ItkImage<Voxel>>::New();
    writer->SetImageIO(ImageIO::New());
    writer->SetFileName(path.string());
    writer->SetInput(image);
    writer->UseCompressionOn();
    bool written = true;
    try {
        writer->Update();
    } catch (const itk::ExceptionObject&) {
        written = false;
    }
    if (!written || !ends_whole(path, before + voxels.size_bytes()))
        throw SystemFailure(
            {path.string(), "could not be written", "", "check free space and permissions of its folder"});
}

template <typename Voxel>
void write_nrrd(const std::filesystem::path& path, const ImageGrid& grid, std::span<const Voxel> voxels,
                const std::map<std::string, std::string>& header) {
    write_packed<itk::NrrdImageIO>(path, grid, voxels, header, 0);
}

// ITK turns LPS into NIfTI's RAS and sets qform and sform alike.
template <typename Voxel>
void write_nifti(const std::filesystem::path& path, const ImageGrid& grid, std::span<const Voxel> voxels) {
    constexpr std::uint64_t header_bytes = 352;
    write_packed<itk::NiftiImageIO>(path, grid, voxels, {}, header_bytes);
}

bool fits_bytes(const LabelMap& map) {
    return std::ranges::none_of(map.labels, [](std::uint16_t value) { return value > 255; });
}

// Precondition: fits_bytes().
std::vector<std::uint8_t> as_bytes(const LabelMap& map) {
    std::vector<std::uint8_t> labels(map.labels.size());
    std::ranges::transform(map.labels, labels.begin(),
                           [](std::uint16_t value) { return static_cast<std::uint8_t>(value); });
    return labels;
}

}  // namespace

void require_ending(const std::filesystem::path& output, std::string_view ending) {
    if (!output.string().ends_with(ending))
        throw InvalidInput(
            {output.string(), "has another ending", std::string(ending), "name the output accordingly"});
}

void write_volume(const std::filesystem::path& path, const Volume& volume) {
    constexpr float low = std::numeric_limits<std::int16_t>::min();
    constexpr float high = std::numeric_limits<std::int16_t>::max();
    const bool integral = std::ranges::all_of(volume.values, [](float value) {
        return value >= low && value <= high && value == std::floor(value);
    });
    if (!integral) return write_nrrd<float>(path, volume.grid, volume.values, {});
    std::vector<std::int16_t> values(volume.values.size());
    std::ranges::transform(volume.values, values.begin(),
                           [](float value) { return static_cast<std::int16_t>(value); });
    write_nrrd<std::int16_t>(path, volume.grid, values, {});
}

void require_few_labels(const LabelMap& map, const std::string& culprit) {
    constexpr std::size_t most = 1300;  // six lines each of the 8192 that text_headers.hpp allows
    if (map.names.size() > most)
        throw InvalidInput({culprit, fmt::format("holds {} labels", map.names.size()),
                            fmt::format("{} at most", most),
                            "choose a label map, not a grey volume, or some of its labels by --label-names "
                            "5=liver,4=gallbladder"});
}

void write_label_map(const std::filesystem::path& path, const LabelMap& map) {
    require_few_labels(map, path.string());
    std::map<std::string, std::string> header{
        {"Segmentation_MasterRepresentation", "Binary labelmap"},
        {"Segmentation_ContainedRepresentationNames", "Binary labelmap|"},
        {"Segmentation_ReferenceImageExtentOffset", "0 0 0"}};
    for (std::size_t n = 0; n < map.names.size(); ++n) {
        const Label& label = map.names[n];
        const std::string prefix = fmt::format("Segment{}_", n);
        header[prefix + "ID"] = fmt::format("Segment_{}", label.value);
        header[prefix + "Name"] = label.name;
        header[prefix + "LabelValue"] = std::to_string(label.value);
        header[prefix + "Layer"] = "0";
        header[prefix + "Color"] =
            fmt::format("{:.6g} {:.6g} {:.6g}", label.colour[0], label.colour[1], label.colour[2]);
        header[prefix + "Extent"] =
            fmt::format("0 {} 0 {} 0 {}", map.grid.size[0] - 1, map.grid.size[1] - 1, map.grid.size[2] - 1);
    }
    if (!fits_bytes(map)) return write_nrrd<std::uint16_t>(path, map.grid, map.labels, header);
    write_nrrd<std::uint8_t>(path, map.grid, as_bytes(map), header);
}

void write_nifti_labels(const std::filesystem::path& path, const LabelMap& map) {
    if (!fits_bytes(map)) return write_nifti<std::uint16_t>(path, map.grid, map.labels);
    write_nifti<std::uint8_t>(path, map.grid, as_bytes(map));
}

}  // namespace palpate::imaging
