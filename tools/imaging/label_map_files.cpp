// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <itkObject.h>
#include <optional>
#include <sstream>

#include "formats/model/errors.hpp"
#include "tools/imaging/read_image.hpp"

namespace palpate {
namespace {

std::optional<std::string> field(const std::map<std::string, std::string>& header, const std::string& key) {
    const auto found = header.find(key);
    return found == header.end() ? std::nullopt : std::optional(found->second);
}

// Names and colours by value, from the SegmentN_* fields.
std::map<std::int32_t, Label> segments_of(const std::map<std::string, std::string>& header,
                                          const std::filesystem::path& path) {
    std::map<std::int32_t, Label> labels;
    for (int n = 0;; ++n) {
        const std::string prefix = fmt::format("Segment{}_", n);
        const auto name = field(header, prefix + "Name");
        const auto value = field(header, prefix + "LabelValue");
        if (!name || !value) break;
        if (field(header, prefix + "Layer").value_or("0") != "0")
            throw InvalidInput({path.string(), "segment \"" + *name + "\" lies in a second layer",
                                "one layer, without overlaps", "export it as a label map from 3D Slicer"});
        Label label;
        std::istringstream number(*value);
        if (!(number >> label.value))
            throw InvalidInput({path.string(), prefix + "LabelValue is '" + *value + "'", "an integer",
                                "correct the header"});
        label.name = *name;
        label.colour = default_label_colour(label.value);
        std::istringstream colour(field(header, prefix + "Color").value_or(""));
        if (std::array<float, 3> rgb{}; colour >> rgb[0] >> rgb[1] >> rgb[2]) label.colour = rgb;
        labels[label.value] = label;
    }
    return labels;
}

}  // namespace

LabelMap read_label_map(const std::filesystem::path& path, const NoteSink& note) {
    itk::Object::GlobalWarningDisplayOff();
    if (!std::filesystem::is_regular_file(path))
        throw InvalidInput({path.string(), "no such file", "", "check the path"});
    const ReadImage image = read_image_file(path, note);
    LabelMap map;
    map.grid = image.volume.grid;
    map.labels.reserve(image.volume.values.size());
    std::vector<bool> occurs(65536, false);
    for (const float value : image.volume.values) {
        if (!(value >= 0 && value <= 65535) || value != std::floor(value))
            throw InvalidInput({path.string(), fmt::format("holds the value {}", value),
                                "integers of 0 ... 65535", "choose a label map, not a grey volume"});
        map.labels.push_back(static_cast<std::uint16_t>(value));
        occurs[map.labels.back()] = true;
    }
    const std::map<std::int32_t, Label> known = segments_of(image.header, path);
    for (std::int32_t value = 1; value < 65536; ++value) {
        if (!occurs[static_cast<std::size_t>(value)]) continue;
        const auto segment = known.find(value);
        map.names.push_back(segment != known.end()
                                ? segment->second
                                : Label{value, fmt::format("label_{}", value), default_label_colour(value)});
    }
    if (map.names.empty())
        throw InvalidInput({path.string(), "is empty: every voxel is background", "",
                            "choose another file or segment again"});
    return map;
}

}  // namespace palpate
