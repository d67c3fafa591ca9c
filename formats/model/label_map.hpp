// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/model/image_grid.hpp"

namespace palpate {

/// One named structure of a label map.
struct Label {
    std::int32_t value = 0;  ///< 1 ... 65535; 0 is background
    std::string name;
    std::array<float, 3> colour{0.8F, 0.8F, 0.8F};  ///< RGB, 0 ... 1
};

/// Non-overlapping structures on a grid.
struct LabelMap {
    ImageGrid grid;
    std::vector<std::uint16_t> labels;  ///< voxel_count() values, i fastest; 0 is background
    std::vector<Label> names;           ///< ascending by value
};

/// All labels that `key` means: by name exactly, where there is none ignoring case and with spaces like
/// underscores, and where there is none, if `key` is a number, by value.
std::vector<Label> labels_called(std::span<const Label> labels, std::string_view key);

/// The first of labels_called().
std::optional<Label> find_label(std::span<const Label> labels, std::string_view key);
inline std::optional<Label> find_label(const LabelMap& map, std::string_view key) {
    return find_label(map.names, key);
}

/// Returns up to three names of `candidates` nearest to `key` by edit distance, best first.
std::vector<std::string> nearest_names(std::string_view key, const std::vector<std::string>& candidates);

/// The one of labels_called(). Throws InvalidInput naming `culprit`, and the nearest names where there is
/// none, or the values where two have one name.
Label require_label(std::span<const Label> labels, std::string_view key, const std::string& culprit);
inline Label require_label(const LabelMap& map, std::string_view key, const std::string& culprit) {
    return require_label(map.names, key, culprit);
}

/// Distinct colours for labels without one of their own, by label value.
std::array<float, 3> default_label_colour(std::int32_t value);

}  // namespace palpate
