// SPDX-License-Identifier: GPL-3.0-or-later
// DICOM files written byte by byte (PS3.5 explicit little endian, PS3.10): an oracle that shares no code with
// the readers.
#pragma once
#include <map>

#include "tests/tools/imaging/hand_written_images.hpp"

namespace palpate::test {

inline std::string little_endian(std::uint64_t value, std::size_t bytes) {
    std::string text;
    for (std::size_t i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 0xff);
    return text;
}

/// Elements by tag (group << 16 | element), written in ascending order.
class DicomData {
  public:
    DicomData& text(std::uint32_t tag, const std::string& vr, const std::string& value) {
        elements_[tag] = {vr, value + std::string(value.size() % 2, vr == "UI" ? '\0' : ' ')};
        return *this;
    }
    DicomData& us(std::uint32_t tag, int value) {
        elements_[tag] = {"US", little_endian(static_cast<std::uint64_t>(value), 2)};
        return *this;
    }
    DicomData& sequence(std::uint32_t tag, const std::vector<DicomData>& items) {
        std::string value;
        for (const DicomData& item : items) {
            const std::string bytes = item.bytes();
            value += "\xfe\xff" + std::string("\x00\xe0", 2) + little_endian(bytes.size(), 4) + bytes;
        }
        elements_[tag] = {"SQ", value};
        return *this;
    }
    void erase(std::uint32_t tag) { elements_.erase(tag); }

    std::string bytes() const {
        std::string all;
        for (const auto& [tag, element] : elements_) {
            const auto& [vr, value] = element;
            const bool long_length = vr == "OW" || vr == "OB" || vr == "SQ" || vr == "UN" || vr == "UT";
            all += little_endian(tag >> 16, 2) + little_endian(tag & 0xffff, 2) + vr;
            all += long_length ? std::string(2, '\0') + little_endian(value.size(), 4)
                               : little_endian(value.size(), 2);
            all += value;
        }
        return all;
    }

    /// A file of this data set.
    std::string file() const {
        const std::string meta = DicomData()
                                     .text(0x00020002, "UI", "1.2.840.10008.5.1.4.1.1.2")
                                     .text(0x00020003, "UI", "1.2.3")
                                     .text(0x00020010, "UI", "1.2.840.10008.1.2.1")
                                     .bytes();
        const std::string preamble(128, '\0'), length("\x02\x00\x00\x00UL\x04\x00", 8);
        return preamble + "DICM" + length + little_endian(meta.size(), 4) + meta + bytes();
    }

  private:
    std::map<std::uint32_t, std::pair<std::string, std::string>> elements_;
};

inline std::string decimals(std::initializer_list<double> values) {
    std::string text;
    for (const double value : values) text += fmt::format("{}{:.9g}", text.empty() ? "" : "\\", value);
    return text;
}

inline std::string decimals(const Eigen::Vector3d& v) {
    return decimals({v[0], v[1], v[2]});
}

inline std::string orientation(const ImageGrid& grid) {
    return decimals(grid.direction.col(0)) + "\\" + decimals(grid.direction.col(1));
}

/// Sizes, spacing and coding of 16-bit signed pixels, without their place.
inline DicomData ct_pixels(const ImageGrid& grid, std::span<const std::int16_t> stored) {
    return DicomData()
        .text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2")
        .text(0x00080018, "UI", "1.2.3.4")
        .text(0x00080060, "CS", "CT")
        .text(0x0008103e, "LO", "portal venous")
        .text(0x0020000d, "UI", "1.2.3.4.5")
        .text(0x0020000e, "UI", "1.2.3.4.5.1")
        .text(0x00200011, "IS", "7")
        .us(0x00280002, 1)
        .text(0x00280004, "CS", "MONOCHROME2")
        .us(0x00280010, grid.size[1])
        .us(0x00280011, grid.size[0])
        .us(0x00280100, 16)
        .us(0x00280101, 16)
        .us(0x00280102, 15)
        .us(0x00280103, 1)
        .text(0x7fe00010, "OW", raw_bytes(stored));
}

/// One CT slice with its first voxel at p_P `origin`; a value is slope * stored + intercept.
inline DicomData ct_slice(const ImageGrid& grid, const Eigen::Vector3d& origin,
                          std::span<const std::int16_t> stored, double slope = 1, double intercept = 0) {
    return ct_pixels(grid, stored)
        .text(0x00180050, "DS", "3")
        .text(0x00200032, "DS", decimals(origin))
        .text(0x00200037, "DS", orientation(grid))
        .text(0x00280030, "DS", decimals({grid.spacing[1], grid.spacing[0]}))
        .text(0x00281052, "DS", decimals({intercept}))
        .text(0x00281053, "DS", decimals({slope}));
}

/// One file of all slices of a grid, their numbers in `order`, with functional groups (PS3.3 C.7.6.16): a
/// value of slice k is 300 + 0.01 (k + 1) * stored.
inline DicomData enhanced_ct(const ImageGrid& grid, std::span<const std::int16_t> stored,
                             const std::vector<int>& order) {
    std::vector<DicomData> frames;
    for (const int k : order)
        frames.push_back(
            DicomData()
                .sequence(0x00209113,
                          {DicomData().text(0x00200032, "DS", decimals(grid.point_of({0, 0, 1.0 * k})))})
                .sequence(0x00289145, {DicomData()
                                           .text(0x00281052, "DS", "300")
                                           .text(0x00281053, "DS", decimals({0.01 * (k + 1)}))}));
    const DicomData shared =
        DicomData()
            .sequence(0x00209116, {DicomData().text(0x00200037, "DS", orientation(grid))})
            .sequence(0x00289110,
                      {DicomData().text(0x00280030, "DS", decimals({grid.spacing[1], grid.spacing[0]}))});
    return ct_pixels(grid, stored)
        .text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2.1")
        .text(0x00280008, "IS", std::to_string(order.size()))
        .sequence(0x52009229, {shared})
        .sequence(0x52009230, frames);
}

/// A series as small as GDCM's codecs take: two slices, whose stored values differ by one.
inline ImageGrid two_slices() {
    ImageGrid grid;
    grid.size = {12, 10, 2};
    grid.spacing = {0.75, 0.5, 2};
    grid.origin = {-40.5, 20.25, 310};
    return grid;
}

inline std::vector<std::int16_t> values_of_slice(int k) {
    std::vector<std::int16_t> values;
    for (int n = 0; n < 120; ++n) values.push_back(static_cast<std::int16_t>(n * 37 % 101 - 50 + k));
    return values;
}

inline DicomData slice_of_two(int k) {
    const ImageGrid grid = two_slices();
    return ct_slice(grid, grid.point_of({0, 0, 1.0 * k}), values_of_slice(k));
}

}  // namespace palpate::test
