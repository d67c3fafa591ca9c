// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/dicom/dicom_pixels.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>
#include <string_view>
#include <utility>

#include "formats/model/errors.hpp"
#include "tools/imaging/dicom/dicom_structure.hpp"
#include "tools/imaging/dicom/filled_apart.hpp"

namespace palpate::imaging {
namespace {

using FrameCode = std::string;  // bytes

InvalidInput pixel_refusal(const DicomSlice& slice, const std::string& found) {
    return InvalidInput({slice.file, found, "whole grey pixels that GDCM can decode",
                         "copy the file again, or decompress it with 'gdcmconv --raw'"});
}

std::uint32_t coded_number(std::string_view bytes, std::size_t at, std::size_t width, bool big_endian) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < width && at + width <= bytes.size(); ++i) {
        const auto byte = static_cast<unsigned char>(bytes[at + i]);
        value |= std::uint32_t{byte} << 8 * (big_endian ? width - 1 - i : i);
    }
    return value;
}

// What the head of a frame's code says of it.
struct CodeHead {
    std::uint32_t columns = 0, rows = 0, components = 0, bits = 0;
};

// Of JPEG and JPEG-LS (ISO 10918-1 B.2.2, 14495-1 C.2.2): the first frame header.
CodeHead jpeg_head(std::string_view code) {
    for (std::size_t at = 2; at + 4 <= code.size();) {
        const std::uint32_t marker = coded_number(code, at, 2, true);
        const bool of_frame = (marker >= 0xffc0 && marker <= 0xffcf && marker != 0xffc4 && marker != 0xffc8 &&
                               marker != 0xffcc) ||
                              marker == 0xfff7;
        if (of_frame && at + 10 <= code.size())
            return {coded_number(code, at + 7, 2, true), coded_number(code, at + 5, 2, true),
                    coded_number(code, at + 9, 1, true), coded_number(code, at + 4, 1, true)};
        if (marker < 0xffc0 || marker == 0xffda) break;
        at += 2 + coded_number(code, at + 2, 2, true);
    }
    return {};
}

// Of JPEG 2000 (ISO 15444-1 A.5.1); sizes from the origin, one tile at most a pixel.
CodeHead jpeg2000_head(std::string_view code) {
    if (code.size() < 45 || coded_number(code, 0, 4, true) != 0xff4fff51) return {};
    const std::uint32_t right = coded_number(code, 8, 4, true), lower = coded_number(code, 12, 4, true),
                        left = coded_number(code, 16, 4, true), upper = coded_number(code, 20, 4, true);
    if (right <= left || lower <= upper || coded_number(code, 24, 4, true) == 0 ||
        coded_number(code, 28, 4, true) == 0 || coded_number(code, 43, 2, true) != 0x0101)
        return {};
    return {right - left, lower - upper, coded_number(code, 40, 2, true),
            (coded_number(code, 42, 1, true) & 0x7fU) + 1};
}

// Of RLE (PS3.5 annex G): as many segments as bytes a pixel, one after the other.
CodeHead rle_head(std::string_view code, const DicomSlice& slice) {
    constexpr std::size_t head = 64;
    const std::uint32_t segments = coded_number(code, 0, 4, false);
    if (code.size() < head || segments > 4) return {};
    std::uint32_t last = head - 1;
    for (std::uint32_t s = 0; s < segments; ++s) {
        const std::uint32_t offset = coded_number(code, 4 + 4 * s, 4, false);
        if (offset <= last || offset >= code.size()) return {};
        last = offset;
    }
    return {static_cast<std::uint32_t>(slice.size[0]), static_cast<std::uint32_t>(slice.size[1]), 1,
            8 * segments};
}

// GDCM allocates what a head claims, and aborts where it differs from the file's.
void check_head(std::string_view code, const DicomPixels& pixels, const DicomSlice& slice) {
    const std::uint32_t start = coded_number(code, 0, 4, true);
    const bool rle = pixels.syntax == "1.2.840.10008.1.2.5";
    const CodeHead head = rle                     ? rle_head(code, slice)
                          : start == 0xff4fff51   ? jpeg2000_head(code)
                          : start >> 16 == 0xffd8 ? jpeg_head(code)
                                                  : CodeHead{};
    const auto allocated = static_cast<std::uint32_t>(slice.format.allocated);
    const bool fits = head.columns == static_cast<std::uint32_t>(slice.size[0]) &&
                      head.rows == static_cast<std::uint32_t>(slice.size[1]) && head.components == 1 &&
                      head.bits <= allocated && (rle ? head.bits == allocated : head.bits > allocated / 2);
    if (!fits)
        throw pixel_refusal(slice,
                            fmt::format("holds compressed pixels of another kind than its header tells: {} x "
                                        "{} of {} times {} bits",
                                        head.columns, head.rows, head.components, head.bits));
}

// The fragments of each frame, joined: all of a single one, one each, or as the table of offsets says.
std::vector<FrameCode> frame_codes(const DicomPixels& pixels, std::size_t frames, const DicomSlice& slice) {
    if (pixels.parts.size() == frames) return pixels.parts;
    std::vector<FrameCode> joined(frames);
    std::size_t at = 0, frame = 0;
    for (const std::string& part : pixels.parts) {
        while (frames > 1 && frame + 1 < frames &&
               coded_number(pixels.offsets, 4 * (frame + 1), 4, false) <= at &&
               4 * (frame + 2) <= pixels.offsets.size())
            ++frame;
        joined[frame] += part;
        at += 8 + part.size();
    }
    if (frame + 1 != frames) throw pixel_refusal(slice, "holds fewer frames than its header claims");
    return joined;
}

gdcm::TransferSyntax::TSType decodable(const DicomPixels& pixels, const DicomSlice& slice) {
    using gdcm::TransferSyntax;
    constexpr std::array known{TransferSyntax::JPEGBaselineProcess1,
                               TransferSyntax::JPEGExtendedProcess2_4,
                               TransferSyntax::JPEGLosslessProcess14,
                               TransferSyntax::JPEGLosslessProcess14_1,
                               TransferSyntax::JPEGLSLossless,
                               TransferSyntax::JPEGLSNearLossless,
                               TransferSyntax::JPEG2000Lossless,
                               TransferSyntax::JPEG2000,
                               TransferSyntax::RLELossless};
    for (const auto syntax : known)
        if (pixels.syntax == TransferSyntax::GetTSString(syntax)) return syntax;
    throw pixel_refusal(slice, "is compressed by transfer syntax " + pixels.syntax);
}

// As bits up to the highest: what lies below the used ones is moved away later.
bool decode_frame(const FrameCode& code, gdcm::TransferSyntax::TSType syntax, const DicomSlice& slice,
                  std::span<char> values) {
    const auto as_short = [](int number) { return static_cast<unsigned short>(number); };
    gdcm::Image image;
    image.SetTransferSyntax(gdcm::TransferSyntax(syntax));
    image.SetNumberOfDimensions(2);
    image.SetDimension(0, static_cast<unsigned>(slice.size[0]));
    image.SetDimension(1, static_cast<unsigned>(slice.size[1]));
    const DicomPixelFormat& f = slice.format;
    image.SetPixelFormat(gdcm::PixelFormat(1, as_short(f.allocated), as_short(f.high + 1), as_short(f.high),
                                           as_short(f.has_sign ? 1 : 0)));
    image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
    gdcm::Fragment fragment;
    fragment.SetByteValue(code.data(), static_cast<std::uint32_t>(code.size()));
    const auto fragments = gdcm::SequenceOfFragments::New();
    fragments->AddFragment(fragment);
    gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010), 0, gdcm::VR::OB);
    pixels.SetValue(*fragments);
    image.SetDataElement(pixels);
    return image.GetBufferLength() == values.size() && image.GetBuffer(values.data()) &&
           image.GetBufferLength() == values.size();
}

// Moves the used bits down, and fills those above with zeros or the sign.
template <typename Stored>
void clean_bits(std::span<char> bytes, const DicomPixelFormat& format, bool swapped) {
    using Unsigned = std::make_unsigned_t<Stored>;
    constexpr int bits = 8 * sizeof(Stored);
    for (std::size_t at = 0; at < bytes.size(); at += sizeof(Stored)) {
        if (swapped)
            std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                         bytes.begin() + static_cast<std::ptrdiff_t>(at + sizeof(Stored)));
        Unsigned raw;
        std::memcpy(&raw, &bytes[at], sizeof(raw));
        raw = static_cast<Unsigned>(raw << (bits - 1 - format.high));
        const auto value = static_cast<Stored>(static_cast<Stored>(raw) >> (bits - format.stored));
        std::memcpy(&bytes[at], &value, sizeof(value));
    }
}

void clean_bits(std::span<char> bytes, const DicomPixelFormat& format, bool swapped) {
    switch (format.allocated) {
        case 8:
            return format.has_sign ? clean_bits<std::int8_t>(bytes, format, swapped)
                                   : clean_bits<std::uint8_t>(bytes, format, swapped);
        case 16:
            return format.has_sign ? clean_bits<std::int16_t>(bytes, format, swapped)
                                   : clean_bits<std::uint16_t>(bytes, format, swapped);
        default:
            return format.has_sign ? clean_bits<std::int32_t>(bytes, format, swapped)
                                   : clean_bits<std::uint32_t>(bytes, format, swapped);
    }
}

}  // namespace

std::string type_of(const DicomPixelFormat& format) {
    return fmt::format("{}int{}", format.has_sign ? "" : "u", format.allocated);
}

std::vector<char> stored_values(const DicomSlice& slice, std::size_t frames) {
    const DicomPixelFormat& format = slice.format;
    if (format.allocated != 8 && format.allocated != 16 && format.allocated != 32)
        throw pixel_refusal(slice, "holds pixels of type " + type_of(format));
    if (format.samples != 1)
        throw pixel_refusal(slice, fmt::format("holds {} values per pixel", format.samples));
    const DicomPixels pixels = read_dicom_pixels(slice.file);
    const std::size_t frame_size = static_cast<std::size_t>(slice.size[0]) *
                                   static_cast<std::size_t>(slice.size[1]) *
                                   static_cast<std::size_t>(format.allocated) / 8;
    if (pixels.parts.empty()) throw pixel_refusal(slice, "holds no pixels");
    if (!pixels.compressed) {
        const std::string& bytes = pixels.parts.front();
        if (bytes.size() < frames * frame_size)
            throw pixel_refusal(slice, "holds fewer pixels than its header claims");
        std::vector<char> values(bytes.begin(),
                                 bytes.begin() + static_cast<std::ptrdiff_t>(frames * frame_size));
        clean_bits(values, format, pixels.big_endian);
        return values;
    }
    gdcm::Trace::ErrorOff();
    gdcm::Trace::WarningOff();
    const auto syntax = decodable(pixels, slice);
    const std::vector<FrameCode> codes = frame_codes(pixels, frames, slice);
    for (const FrameCode& code : codes) check_head(code, pixels, slice);
    // Debian's GDCM keeps its assertions, and damaged pixels meet some of its hundreds.
    auto values = filled_apart(frames * frame_size, [&](std::span<char> all) {
        for (std::size_t i = 0; i < frames; ++i)
            if (!decode_frame(codes[i], syntax, slice, all.subspan(i * frame_size, frame_size))) return false;
        return true;
    });
    if (!values) throw pixel_refusal(slice, "its pixels cannot be decoded");
    clean_bits(*values, format, false);
    return std::move(*values);
}

}  // namespace palpate::imaging
