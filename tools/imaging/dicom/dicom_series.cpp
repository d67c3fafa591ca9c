// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/dicom/dicom_series.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <set>
#include <sstream>

#include "formats/model/errors.hpp"
#include "tools/imaging/dicom/dicom_codes.hpp"
#include "tools/imaging/dicom/dicom_structure.hpp"
#include "tools/imaging/files/read_image.hpp"

namespace palpate::imaging {
namespace {

std::string text(const DicomSet& data, std::uint32_t tag) {
    const auto found = data.values.find(tag);
    if (found == data.values.end()) return {};
    std::string value = found->second.bytes;
    const auto padding = [](char c) { return c == ' ' || c == '\0'; };
    while (!value.empty() && padding(value.back())) value.pop_back();
    value.erase(value.begin(), std::ranges::find_if_not(value, padding));
    return value;
}

// Exactly `count` finite numbers separated by backslashes.
std::optional<std::vector<double>> numbers(const DicomSet& data, std::uint32_t tag, std::size_t count) {
    std::vector<double> values;
    std::istringstream parts(text(data, tag));
    for (std::string part; std::getline(parts, part, '\\');) {
        std::erase_if(part, [](char c) { return c == ' ' || c == '+'; });
        double value = 0;
        const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
        if (error != std::errc{} || end != part.data() + part.size() || !std::isfinite(value))
            return std::nullopt;
        values.push_back(value);
    }
    if (values.size() != count) return std::nullopt;
    return values;
}

std::int32_t whole_number(const DicomSet& data, std::uint32_t tag, std::int32_t otherwise) {
    const auto value = numbers(data, tag, 1);
    return value && std::abs((*value)[0]) < 1e9 ? static_cast<std::int32_t>((*value)[0]) : otherwise;
}

DicomPixelFormat pixel_format(const DicomSet& data, const std::string& file) {
    const int samples = unsigned_short(data, 0x00280002), allocated = unsigned_short(data, 0x00280100),
              stored = unsigned_short(data, 0x00280101), high = unsigned_short(data, 0x00280102),
              sign = unsigned_short(data, 0x00280103);
    const bool whole_bytes =
        allocated == 1 || allocated == 8 || allocated == 16 || allocated == 32 || allocated == 64;
    if (samples == 2 || samples > 4 || !whole_bytes || stored < 1 || stored > allocated ||
        high >= allocated || high < stored - 1 || sign > 1)
        throw InvalidInput({file,
                            fmt::format("{} samples of {} bits, {} of them used up to bit {}", samples,
                                        allocated, stored, high),
                            "a pixel format of DICOM", "copy or export the file again"});
    return {allocated, stored, high, sign == 1, std::max(samples, 1)};
}

// An item of a sequence; an empty set if there is none.
const DicomSet& item(const DicomSet& data, std::uint32_t tag, std::size_t position = 0) {
    static const DicomSet none;
    const auto found = data.values.find(tag);
    return found != data.values.end() && position < found->second.items.size() ? found->second.items[position]
                                                                               : none;
}

// A number that may be missing, but not damaged.
double number_or(double otherwise, const DicomSet& data, std::uint32_t tag, const std::string& file) {
    if (text(data, tag).empty()) return otherwise;
    const auto value = numbers(data, tag, 1);
    if (!value)
        throw InvalidInput({file,
                            fmt::format("element ({:04x},{:04x}) is no number", tag >> 16, tag & 0xffffU),
                            "a finite number", "copy or export the file again"});
    return (*value)[0];
}

// What one set says of the slice: the file's own attributes, or those in its functional groups.
void take_geometry(DicomSlice& slice, const DicomSet& position, const DicomSet& orientation,
                   const DicomSet& measures, const DicomSet& rescale) {
    if (const auto p = numbers(position, 0x00200032, 3)) slice.origin = {(*p)[0], (*p)[1], (*p)[2]};
    if (const auto o = numbers(orientation, 0x00200037, 6))
        slice.directions = Eigen::Map<const Eigen::Matrix<double, 3, 2>>(o->data());
    if (const auto s = numbers(measures, 0x00280030, 2)) slice.spacing = {(*s)[1], (*s)[0]};
    slice.intercept = number_or(slice.intercept, rescale, 0x00281052, slice.file);
    if (const double slope = number_or(slice.slope, rescale, 0x00281053, slice.file); slope != 0)
        slice.slope = slope;
}

void take_functional_groups(DicomSlice& slice, const DicomSet& groups) {
    take_geometry(slice, item(groups, 0x00209113), item(groups, 0x00209116), item(groups, 0x00289110),
                  item(groups, 0x00289145));
}

std::vector<DicomSlice> slices_of(const DicomSet& data, const std::string& file) {
    DicomSlice slice;
    slice.file = file;
    slice.size = {unsigned_short(data, 0x00280011), unsigned_short(data, 0x00280010)};
    if (slice.size[0] == 0 || slice.size[1] == 0) return {};
    take_geometry(slice, data, data, data, data);
    const std::int32_t frames = std::clamp(whole_number(data, 0x00280008, 1), 1, 65535);
    if (frames == 1 && slice.origin) return {slice};
    take_functional_groups(slice, item(data, 0x52009229));
    // Of frames that the file does not tell of, two suffice to refuse it: they have no place, or both the
    // same.
    const auto told = data.values.find(0x52009230);
    const std::size_t most = 2 + (told == data.values.end() ? 0 : told->second.items.size());
    std::vector<DicomSlice> slices(std::min(static_cast<std::size_t>(frames), most), slice);
    for (std::size_t i = 0; i < slices.size(); ++i) {
        slices[i].frame = i;
        take_functional_groups(slices[i], item(data, 0x52009230, i));
    }
    return slices;
}

// The kind of a file that is no image of a volume; empty for an image.
std::string other_kind(const DicomSet& data) {
    static const std::set<std::string> kinds{"SEG",      "RTSTRUCT", "RTDOSE", "RTPLAN", "RTIMAGE",
                                             "RTRECORD", "SR",       "PR",     "KO",     "REG",
                                             "FID",      "DOC",      "RWV",    "ANN"};
    const std::string modality = text(data, 0x00080060);
    return kinds.contains(modality) ? modality : "";
}

// Files without series UID belong together if all of this is the same.
std::string series_key(const DicomSet& data, const std::string& uid, bool localizer) {
    std::string key = uid;
    if (uid.empty())
        for (const std::uint32_t tag : {0x00200011, 0x0008103e, 0x00080060, 0x00200037, 0x00280030})
            key.append("|").append(text(data, tag));
    return key + (localizer ? "|localizer" : "");
}

std::vector<std::filesystem::path> files_below(const std::filesystem::path& path) {
    std::error_code error;  // as of links that lead nowhere or to themselves
    if (!std::filesystem::is_directory(path, error)) return {path};
    std::vector<std::filesystem::path> files;
    const auto options = std::filesystem::directory_options::skip_permission_denied;
    for (std::filesystem::recursive_directory_iterator entry(path, options, error), end;
         !error && entry != end; entry.increment(error))
        if (std::error_code none; entry->is_regular_file(none)) files.push_back(entry->path());
    if (error)
        throw InvalidInput({path.string(), "cannot be listed: " + error.message(), "", "check the folder"});
    std::ranges::sort(files);
    return files;
}

// Nothing for a file that is no DICOM.
std::optional<DicomSet> header_of(const std::filesystem::path& file) {
    try {
        return read_dicom_header(file);
    } catch (const InvalidInput&) {
        if (is_dicom(file)) throw;
        return std::nullopt;
    }
}

void complete_summary(DicomSeries& series) {
    const DicomSlice& first = series.slices.front();
    SeriesSummary& summary = series.summary;
    summary.size = {first.size[0], first.size[1], static_cast<std::int32_t>(series.slices.size())};
    if (first.spacing) summary.spacing.head<2>() = *first.spacing;
    std::vector<double> positions;
    for (const DicomSlice& slice : series.slices)
        if (slice.origin && first.directions)
            positions.push_back(first.directions->col(0).cross(first.directions->col(1)).dot(*slice.origin));
    std::ranges::sort(positions);
    std::vector<double> gaps;
    for (std::size_t i = 1; i < positions.size(); ++i) gaps.push_back(positions[i] - positions[i - 1]);
    std::ranges::sort(gaps);
    if (!gaps.empty()) summary.spacing[2] = gaps[gaps.size() / 2];
}

}  // namespace

std::vector<DicomSeries> scan_dicom(const std::filesystem::path& path, const NoteSink& note) {
    require_image_source(path);
    std::map<std::string, DicomSeries> by_key;
    std::map<std::string, int> skipped;
    for (const std::filesystem::path& file : files_below(path)) {
        const auto read = header_of(file);
        if (!read) continue;
        const DicomSet& data = *read;
        if (const std::string kind = other_kind(data); !kind.empty()) {
            ++skipped[kind];
            continue;
        }
        std::vector<DicomSlice> slices = slices_of(data, file.string());
        if (slices.empty()) {
            ++skipped["DICOMDIR or other"];
            continue;
        }
        const DicomPixelFormat format = pixel_format(data, file.string());
        for (DicomSlice& slice : slices) slice.format = format;
        const std::string uid = text(data, 0x0020000e);
        const bool localizer = text(data, 0x00080008).find("LOCALIZER") != std::string::npos;
        DicomSeries& series = by_key[series_key(data, uid, localizer)];
        if (series.slices.empty()) {
            series.summary.number = text(data, 0x00200011);
            series.summary.modality = modality_code(text(data, 0x00080060));
            series.summary.description = as_utf8(text(data, 0x0008103e));
            series.summary.uid = as_utf8(uid);
            series.summary.localizer = localizer;
        }
        if (const std::string colours = text(data, 0x00280004);
            !colours.empty() && !colours.starts_with("MONOCHROME"))
            series.colours = photometric_code(colours);
        series.slices.insert(series.slices.end(), slices.begin(), slices.end());
    }
    for (const auto& [kind, count] : skipped)
        if (note) note(fmt::format("skipped {} DICOM files that are no images: {}", count, kind));
    if (by_key.empty())
        throw InvalidInput(
            {path.string(), "holds no DICOM image series", "",
             skipped.contains("SEG")
                 ? "read a DICOM SEG file as a label map, 'palpate import --labels FILE'"
                 : "name the folder that holds the slices, or a NRRD, MetaImage or NIfTI file"});
    std::vector<DicomSeries> all;
    for (auto& [key, series] : by_key) all.push_back(std::move(series));
    for (DicomSeries& series : all) complete_summary(series);
    number_series(all);
    return all;
}

std::vector<SeriesSummary> list_series(const std::filesystem::path& path, const NoteSink& note) {
    std::vector<SeriesSummary> list;
    for (const DicomSeries& series : scan_dicom(path, note)) list.push_back(series.summary);
    return list;
}

}  // namespace palpate::imaging
