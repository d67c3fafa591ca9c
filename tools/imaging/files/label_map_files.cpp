// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <itkObject.h>
#include <optional>
#include <set>
#include <sstream>
#include <unordered_map>

#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"
#include "tools/imaging/files/label_names.hpp"
#include "tools/imaging/files/read_image.hpp"
#include "tools/imaging/files/segment_painter.hpp"

namespace palpate::imaging {
namespace {

// A segment of an NRRD header: the voxels of one value in one layer.
struct Segment {
    Label label;
    std::size_t layer = 0;
};

std::optional<std::string> field(const std::map<std::string, std::string>& header, const std::string& key) {
    const auto found = header.find(key);
    return found == header.end() ? std::nullopt : std::optional(found->second);
}

// A whole number and nothing behind it.
template <typename Number>
bool read_whole(std::istringstream& text, Number& value) {
    return (text >> value) && (text >> std::ws).eof();
}

std::vector<Segment> segments_of(const StoredImage& image, const std::filesystem::path& path) {
    std::vector<Segment> segments;
    for (int n = 0;; ++n) {
        const std::string prefix = fmt::format("Segment{}_", n);
        const auto name = field(image.header, prefix + "Name");
        if (!name) break;
        // 3D Slicer before 5.0 wrote a layer of ones for each segment and neither of these fields.
        const auto value = field(image.header, prefix + "LabelValue");
        const std::string own_layer = value ? "0" : std::to_string(n);
        Segment segment;
        std::istringstream number(value.value_or("1")),
            layer(field(image.header, prefix + "Layer").value_or(own_layer));
        if (!read_whole(number, segment.label.value) || segment.label.value < 0 ||
            segment.label.value > 65535)
            throw InvalidInput({path.string(), prefix + "LabelValue is '" + number.str() + "'",
                                "an integer of 0 ... 65535", "correct the header"});
        if (!read_whole(layer, segment.layer) || segment.layer >= image.layers)
            throw InvalidInput({path.string(), prefix + "Layer is '" + layer.str() + "'",
                                fmt::format("one of its {} layers", image.layers), "correct the header"});
        segment.label.name = as_utf8(*name);
        if (segment.label.name.find_first_not_of(' ') == std::string::npos)
            segment.label.name = fmt::format("label_{}", segment.label.value);
        segment.label.colour = default_label_colour(segment.label.value);
        std::istringstream colour(field(image.header, prefix + "Color").value_or(""));
        if (std::array<float, 3> rgb{}; colour >> rgb[0] >> rgb[1] >> rgb[2]) segment.label.colour = rgb;
        if (segment.label.value > 0) segments.push_back(segment);
    }
    return segments;
}

// All layers as labels, side by side as stored.
std::vector<std::uint16_t> integers_of(StoredImage& image, const std::filesystem::path& path) {
    const bool plain = is_plain(image);
    if (auto* stored = std::get_if<std::vector<std::uint16_t>>(&image.voxels); stored != nullptr && plain)
        return std::move(*stored);
    return std::visit(
        [&](const auto& stored) {
            std::vector<std::uint16_t> labels;
            labels.reserve(stored.size());
            for (const auto voxel : stored) {
                const double value = label_value(image, static_cast<double>(voxel));
                if (!(value >= 0 && value <= 65535) || value != std::floor(value))
                    throw InvalidInput({path.string(), fmt::format("holds the value {}", value),
                                        "integers of 0 ... 65535", "choose a label map, not a grey volume"});
                labels.push_back(static_cast<std::uint16_t>(value));
            }
            return labels;
        },
        image.voxels);
}

LabelMap one_layer(const ImageGrid& grid, std::vector<std::uint16_t> labels, const LabelTable& known) {
    LabelMap map{grid, std::move(labels), {}};
    std::vector<bool> occurs(65536, false);
    for (const std::uint16_t label : map.labels) occurs[label] = true;
    for (std::int32_t value = 1; value < 65536; ++value) {
        if (!occurs[value]) continue;
        const auto found = known.find(value);
        map.names.push_back(found != known.end()
                                ? found->second
                                : Label{value, fmt::format("label_{}", value), default_label_colour(value)});
    }
    return map;
}

LabelMap several_layers(const StoredImage& image, std::span<const std::uint16_t> labels,
                        std::vector<Segment> segments, const std::filesystem::path& path,
                        const NoteSink& note, Overlaps overlaps) {
    // Segments of different layers may share a value; then they are numbered in the order of the file.
    std::set<std::int32_t> values;
    for (const Segment& segment : segments) values.insert(segment.label.value);
    constexpr std::size_t value_count = 65536;
    std::unordered_map<std::size_t, std::size_t> index;  // segment by layer and value
    std::vector<Label> names;
    for (std::size_t i = 0; i < segments.size(); ++i) {
        index[segments[i].layer * value_count + static_cast<std::size_t>(segments[i].label.value)] = i;
        if (values.size() < segments.size()) segments[i].label.value = static_cast<std::int32_t>(i + 1);
        names.push_back(segments[i].label);
    }
    std::vector<std::size_t> voxels(segments.size(), 0);
    const auto segment_at = [&](std::size_t n) {
        const auto segment = index.find(n % image.layers * value_count + labels[n]);
        if (segment == index.end())
            throw InvalidInput(
                {path.string(),
                 fmt::format("holds the value {} in layer {}, of no segment", labels[n], n % image.layers),
                 "a segment in the header for each value", "export the segmentation again"});
        return segment->second;
    };
    for (std::size_t n = 0; n < labels.size(); ++n)
        if (labels[n] != 0) ++voxels[segment_at(n)];
    SegmentPainter painter(image.grid, std::move(names), voxels, overlaps);
    for (std::size_t n = 0; n < labels.size(); ++n)
        if (labels[n] != 0) painter.paint(n / image.layers, segment_at(n));
    return painter.finish(path, note);
}

void require_labels(const LabelMap& map, const std::filesystem::path& path) {
    if (map.names.empty())
        throw InvalidInput({path.string(), "is empty: every voxel is background", "",
                            "choose another file or segment again"});
}

LabelMap label_map_of(StoredImage image, const std::filesystem::path& path, const NoteSink& note,
                      Overlaps overlaps) {
    const std::vector<Segment> segments = segments_of(image, path);
    std::vector<std::uint16_t> labels = integers_of(image, path);
    image.voxels = {};
    if (image.layers > 1) return several_layers(image, labels, segments, path, note, overlaps);
    for (const Segment& segment : segments) image.labels[segment.label.value] = segment.label;
    return one_layer(image.grid, std::move(labels), image.labels);
}

}  // namespace

LabelMap label_map_from(StoredImage image, const std::filesystem::path& path, const NoteSink& note,
                        Overlaps overlaps) {
    LabelMap map = label_map_of(std::move(image), path, note, overlaps);
    require_labels(map, path);
    make_names_unique(map, note);
    return map;
}

LabelMap read_label_map(const std::filesystem::path& path, const NoteSink& note, const ReadOptions& options) {
    itk::Object::GlobalWarningDisplayOff();
    if (std::error_code none; !std::filesystem::is_regular_file(path, none))
        throw InvalidInput({path.string(),
                            std::filesystem::exists(path, none) ? palpate::other_kind(path) : "no such file",
                            "a file with a label map, as .seg.nrrd, .nii.gz or DICOM SEG", "check the path"});
    try {
        if (!is_dicom(path))
            return label_map_from(read_image_file(path, note, options), path, note, options.overlaps);
        LabelMap map = read_dicom_segmentation(path, note, options.overlaps);
        require_labels(map, path);
        make_names_unique(map, note);
        return map;
    } catch (const std::bad_alloc&) {
        throw beyond_memory(path);
    }
}

}  // namespace palpate::imaging
