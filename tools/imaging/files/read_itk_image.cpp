// SPDX-License-Identifier: GPL-3.0-or-later
// NRRD and MetaImage, through ITK.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <iomanip>
#include <itkMetaDataObject.h>
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>
#include <itk_zlib.h>
#include <memory>
#include <optional>
#include <sstream>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/itk_image.hpp"
#include "tools/imaging/files/read_image.hpp"
#include "tools/imaging/files/text_headers.hpp"
#include "tools/imaging/files/trimmed.hpp"

namespace palpate::imaging {
namespace {

itk::ImageIOBase::Pointer image_io_of(const std::filesystem::path& path) {
    const std::array<itk::ImageIOBase::Pointer, 2> candidates{itk::NrrdImageIO::New().GetPointer(),
                                                              itk::MetaImageIO::New().GetPointer()};
    for (const auto& io : candidates)
        if (io->CanReadFile(path.c_str())) return io;
    const std::string ending = in_lower_case(path.extension().string());
    if (ending != path.extension()) {  // ITK knows endings in lower case only
        if (ending == ".nrrd" || ending == ".nhdr") return candidates[0];
        if (ending == ".mha" || ending == ".mhd") return candidates[1];
    }
    if (ending == ".hdr" || ending == ".img")
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

// The fields "name: value" of an NRRD header; names do not depend on case.
std::map<std::string, std::string> nrrd_fields(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::map<std::string, std::string> fields;
    for (std::string line; std::getline(stream, line) && !line.empty() && line != "\r";) {
        if (line.ends_with('\r')) line.pop_back();
        if (const auto colon = line.find(": "); colon != std::string::npos && !line.starts_with('#'))
            fields[in_lower_case(line.substr(0, colon))] = trimmed(line.substr(colon + 2));
    }
    return fields;
}

// The first three vectors "(x,y,z)" of a field as columns; zeros where there are fewer.
Eigen::Matrix3d vectors_of(std::string text) {
    if (const auto none = text.find("none"); none != std::string::npos) text.erase(none, 4);
    std::ranges::replace_if(
        text, [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
    std::istringstream numbers(text);
    Eigen::Matrix3d vectors = Eigen::Matrix3d::Zero();
    for (double& value : vectors.reshaped()) numbers >> value;
    return vectors;
}

// Units in quotes, one for each axis of space.
void require_millimetres(const std::string& units, const std::filesystem::path& path) {
    std::istringstream stream(units);
    for (std::string unit; stream >> std::quoted(unit);)
        if (!unit.empty() && unit != "mm" && unit != "millimeter" && unit != "millimeters")
            throw InvalidInput({path.string(), "has space units " + as_utf8(units).substr(0, 60), "\"mm\"",
                                "convert it to millimetres"});
}

// Whether an NRRD header claims more than its files hold, which ITK would first allocate.
void check_nrrd_claim(std::uintmax_t claimed, const std::filesystem::path& path) {
    const auto fields = nrrd_fields(path);
    std::uintmax_t held = std::filesystem::file_size(path);
    for (const char* key : {"data file", "datafile"}) {
        if (!fields.contains(key)) continue;
        std::error_code none;
        if (const auto file = path.parent_path() / fields.at(key);
            std::filesystem::is_regular_file(file, none))
            held += std::filesystem::file_size(file);
        else  // a list or a pattern of files
            for (const auto& entry :
                 std::filesystem::directory_iterator(std::filesystem::absolute(path).parent_path(), none))
                if (entry.is_regular_file(none)) held += entry.file_size();
    }
    const std::string encoding = fields.contains("encoding") ? in_lower_case(fields.at("encoding")) : "";
    const bool text = encoding == "text" || encoding == "txt" || encoding == "ascii";
    check_claim(claimed, held,
                encoding == "raw" ? Packing::none
                : text            ? Packing::text
                                  : Packing::deflated,
                path);
}

// ITK before its pull request 5224 (2025) mirrors left-anterior-superior along the wrong axis, and takes
// spaces that name no patient as LPS.
void correct_frame(ImageGrid& grid, const std::filesystem::path& path, const NoteSink& note) {
    const auto fields = nrrd_fields(path);
    const std::string space = fields.contains("space") ? in_lower_case(fields.at("space")) : "";
    const auto is = [&](const char* words, const char* letters) {
        return space == words || space == letters;
    };
    if (fields.contains("space units")) require_millimetres(fields.at("space units"), path);
    if (is("left-anterior-superior", "las") && fields.contains("space directions")) {
        Eigen::Matrix3d axes = vectors_of(fields.at("space directions"));
        axes.row(1) *= -1;
        set_axes(grid, axes);
        grid.origin = fields.contains("space origin") ? vectors_of(fields.at("space origin")).col(0).eval()
                                                      : Eigen::Vector3d::Zero();
        grid.origin[1] *= -1;
    } else if (note && !is("left-posterior-superior", "lps") && !is("right-anterior-superior", "ras")) {
        note("the header names no patient space; taken as LPS");
    }
    if (note && !fields.contains("space directions") && !fields.contains("spacings"))
        note("the header names no voxel size; taken as 1 mm along each axis");
}

std::map<std::string, std::string> header_of(const itk::MetaDataDictionary& dictionary) {
    std::map<std::string, std::string> header;
    for (const std::string& key : dictionary.GetKeys())
        if (std::string text; itk::ExposeMetaData(dictionary, key, text)) header[key] = text;
    return header;
}

// Where a MetaImage keeps its voxels.
struct MetaData {
    std::filesystem::path file;
    std::size_t offset = 0;
    bool compressed = false;
    bool big_endian = false;
    bool text = false;
    bool several_files = false;
    double slope = 1, intercept = 0;
};

double number_of(const std::string& key, const std::string& value, const std::filesystem::path& path) {
    double number = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc{} || end != value.data() + value.size() || !(std::abs(number) < 1e12))
        throw InvalidInput({path.string(), "has " + key + " '" + as_utf8(value).substr(0, 40) + "'",
                            "a number", "correct the header"});
    return number;
}

// Nothing if there is no file of voxels.
std::optional<MetaData> meta_data_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    MetaData data;
    double header = 0;  // bytes to skip; -1 lets MetaIO count from the end of the file
    for (std::string line; std::getline(stream, line);) {
        const auto equals = line.find('=');
        if (equals == std::string::npos) continue;
        const std::string key = trimmed(line.substr(0, equals)), value = trimmed(line.substr(equals + 1));
        const bool yes = value.starts_with('T') || value.starts_with('t') || value == "1";
        if (key == "BinaryData") data.text = !yes;
        if (key == "HeaderSize") header = number_of(key, value, path);
        if (key == "ElementToIntensityFunctionSlope") data.slope = number_of(key, value, path);
        if (key == "ElementToIntensityFunctionOffset") data.intercept = number_of(key, value, path);
        if (key == "CompressedData") data.compressed = yes;
        if (key == "BinaryDataByteOrderMSB" || key == "ElementByteOrderMSB") data.big_endian = yes;
        if (key != "ElementDataFile") continue;
        const bool local = in_lower_case(value) == "local";
        data.several_files = in_lower_case(value).starts_with("list") || value.find('%') != std::string::npos;
        if (data.several_files) return data;
        data.file = local ? path : path.parent_path() / value;
        data.offset = local ? static_cast<std::size_t>(stream.tellg()) : 0;
        if (header > 0) data.offset += static_cast<std::size_t>(header);
        if (std::error_code none; std::filesystem::is_regular_file(data.file, none)) return data;
        break;
    }
    return std::nullopt;
}

void check_meta_claim(const MetaData& data, std::uintmax_t claimed, const std::filesystem::path& path) {
    if (data.several_files)
        throw InvalidInput({path.string(),
                            "keeps its voxels in several files (ElementDataFile LIST or a pattern)",
                            "one file of voxels", "convert it to .mha or .nrrd"});
    const std::uintmax_t size = std::filesystem::file_size(data.file);
    check_claim(claimed, size - std::min<std::uintmax_t>(size, data.offset),
                data.compressed ? Packing::deflated
                : data.text     ? Packing::text
                                : Packing::none,
                path);
}

// Whether all of `bytes` came out of the zlib or gzip stream; MetaIO's own reader wants its packed size.
bool inflate_into(const MetaData& data, std::span<std::byte> bytes) {
    std::ifstream stream(data.file, std::ios::binary);
    stream.seekg(static_cast<std::streamoff>(data.offset));
    z_stream state{};
    constexpr int either_header = 15 + 32;
    if (inflateInit2(&state, either_header) != Z_OK) return false;
    const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&state, inflateEnd);
    std::vector<char> packed(1 << 18);
    std::size_t done = 0;
    int status = Z_OK;
    while (status == Z_OK) {
        if (state.avail_in == 0) {
            stream.read(packed.data(), static_cast<std::streamsize>(packed.size()));
            state.next_in = reinterpret_cast<Bytef*>(packed.data());
            state.avail_in = static_cast<uInt>(stream.gcount());
        }
        const auto room = static_cast<uInt>(std::min<std::size_t>(bytes.size() - done, std::size_t{1} << 28));
        state.next_out = reinterpret_cast<Bytef*>(bytes.data() + done);
        state.avail_out = room;
        status = inflate(&state, Z_NO_FLUSH);
        done += room - state.avail_out;
    }
    return status == Z_STREAM_END && done == bytes.size();
}

template <typename Voxel>
std::vector<Voxel> read_voxels(itk::ImageIOBase& io, std::size_t count, const std::optional<MetaData>& meta) {
    std::vector<Voxel> voxels(count);
    const auto bytes = std::as_writable_bytes(std::span(voxels));
    if (!meta || !meta->compressed) {
        io.Read(voxels.data());
    } else if (!inflate_into(*meta, bytes)) {
        voxels.clear();
    } else if (meta->big_endian) {
        for (std::size_t at = 0; at < bytes.size(); at += sizeof(Voxel))
            std::ranges::reverse(bytes.subspan(at, sizeof(Voxel)));
    }
    return voxels;
}

// Nothing if the data are damaged or of another type.
StoredVoxels read_voxels(itk::ImageIOBase& io, std::size_t count, const std::optional<MetaData>& meta) {
    using enum itk::IOComponentEnum;
    switch (io.GetComponentType()) {
        case UCHAR:
            return read_voxels<std::uint8_t>(io, count, meta);
        case CHAR:
            return read_voxels<std::int8_t>(io, count, meta);
        case USHORT:
            return read_voxels<std::uint16_t>(io, count, meta);
        case SHORT:
            return read_voxels<std::int16_t>(io, count, meta);
        case UINT:
            return read_voxels<std::uint32_t>(io, count, meta);
        case INT:
            return read_voxels<std::int32_t>(io, count, meta);
        case ULONG:
        case ULONGLONG:
            return read_voxels<std::uint64_t>(io, count, meta);
        case LONG:
        case LONGLONG:
            return read_voxels<std::int64_t>(io, count, meta);
        case FLOAT:
            return read_voxels<float>(io, count, meta);
        case DOUBLE:
            return read_voxels<double>(io, count, meta);
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
    const itk::ImageIOBase::Pointer io = image_io_of(path);  // looks at 8000 bytes at most
    const bool meta = dynamic_cast<itk::MetaImageIO*>(io.GetPointer()) != nullptr;
    meta ? require_short_metaimage_header(path) : require_short_nrrd_header(path);
    try {
        io->SetFileName(path.string());
        io->ReadImageInformation();
        StoredImage image;
        image.grid = grid_of(*io, path);
        image.layers = io->GetNumberOfComponents();
        image.header = header_of(io->GetMetaDataDictionary());
        if (!meta) correct_frame(image.grid, path, note);
        check_geometry(image.grid, path, note);
        const std::size_t count = image.layers * image.grid.voxel_count();
        itk::ImageIORegion whole(io->GetNumberOfDimensions());
        for (unsigned axis = 0; axis < io->GetNumberOfDimensions(); ++axis)
            whole.SetSize(axis, io->GetDimensions(axis));
        io->SetIORegion(whole);
        const auto meta_data = meta ? meta_data_of(path) : std::nullopt;
        const auto claimed = static_cast<std::uintmax_t>(io->GetImageSizeInBytes());
        if (!meta) check_nrrd_claim(claimed, path);
        if (meta_data) {
            check_meta_claim(*meta_data, claimed, path);
            image.slope = meta_data->slope;
            image.intercept = meta_data->intercept;
        }
        if (!meta || meta_data) image.voxels = read_voxels(*io, count, meta_data);
        if (std::visit([](const auto& voxels) { return voxels.empty(); }, image.voxels))
            throw InvalidInput({path.string(), "holds fewer voxels than its header claims", "",
                                "check that the file is whole"});
        return image;
    } catch (const itk::ExceptionObject& error) {
        throw InvalidInput(
            {path.string(), "cannot be read: " + reason_of(error), "", "check that the file is whole"});
    }
}

}  // namespace palpate::imaging
