// SPDX-License-Identifier: Apache-2.0
#include "formats/model/label_map.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <numeric>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

// As names are compared: lower case, a space like an underscore.
std::string folded(std::string_view text) {
    std::string result(text);
    std::ranges::transform(result, result.begin(), [](unsigned char c) {
        return c == ' ' ? '_' : static_cast<char>(std::tolower(c));
    });
    return result;
}

// Levenshtein distance with two rows.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> previous(b.size() + 1), current(b.size() + 1);
    std::iota(previous.begin(), previous.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        current[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j)
            current[j] = std::min(
                {previous[j] + 1, current[j - 1] + 1, previous[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
        std::swap(previous, current);
    }
    return previous[b.size()];
}

}  // namespace

std::vector<Label> labels_called(std::span<const Label> labels, std::string_view key) {
    const auto those = [&](const auto& is_meant) {
        std::vector<Label> found;
        std::ranges::copy_if(labels, std::back_inserter(found), is_meant);
        return found;
    };
    if (auto exact = those([&](const Label& label) { return label.name == key; }); !exact.empty())
        return exact;
    if (auto alike = those([&](const Label& label) { return folded(label.name) == folded(key); });
        !alike.empty())
        return alike;
    std::int32_t value = 0;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), value);
    if (error != std::errc{} || end != key.data() + key.size()) return {};
    return those([&](const Label& label) { return label.value == value; });
}

std::optional<Label> find_label(std::span<const Label> labels, std::string_view key) {
    const std::vector<Label> found = labels_called(labels, key);
    return found.empty() ? std::nullopt : std::optional(found.front());
}

std::vector<std::string> nearest_names(std::string_view key, const std::vector<std::string>& candidates) {
    std::vector<std::pair<std::size_t, std::string>> ranked;
    const std::string wanted = folded(key);
    for (const std::string& name : candidates) {
        const std::string have = folded(name);
        const bool contained =
            have.find(wanted) != std::string::npos || wanted.find(have) != std::string::npos;
        ranked.emplace_back(contained ? 0 : edit_distance(wanted, have), name);
    }
    std::ranges::stable_sort(ranked, {}, &std::pair<std::size_t, std::string>::first);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < ranked.size() && i < 3; ++i) names.push_back(ranked[i].second);
    return names;
}

Label require_label(std::span<const Label> labels, std::string_view key, const std::string& culprit) {
    const std::vector<Label> found = labels_called(labels, key);
    if (found.size() > 1)
        throw InvalidInput({.culprit = culprit,
                            .found = "labels " + std::to_string(found[0].value) + " and " +
                                     std::to_string(found[1].value) + " are both '" + found[0].name + "'",
                            .expected = "one label of that name",
                            .next_step = "name it by its value, or rename one where they were made"});
    if (!found.empty()) return found.front();
    std::vector<std::string> names;
    for (const Label& label : labels) names.push_back(label.name);
    std::string near;
    for (const std::string& name : nearest_names(key, names))
        near += (near.empty() ? "'" : ", '") + name + "'";
    throw InvalidInput(
        {.culprit = culprit,
         .found = "no label '" + std::string(key) + "'",
         .expected = "",
         .next_step = near.empty() ? "there are no labels; segment first" : "nearest names: " + near});
}

std::array<float, 3> default_label_colour(std::int32_t value) {
    // Hues a golden-ratio step apart stay distinct for any number of labels.
    const float hue = std::fmod(0.08F + 0.618034F * static_cast<float>(value), 1.0F) * 6.0F;
    const float ramp = 1.0F - std::abs(std::fmod(hue, 2.0F) - 1.0F);
    const std::array<std::array<float, 3>, 6> sectors{
        {{1, ramp, 0}, {ramp, 1, 0}, {0, 1, ramp}, {0, ramp, 1}, {ramp, 0, 1}, {1, 0, ramp}}};
    std::array<float, 3> colour = sectors[static_cast<std::size_t>(hue) % 6];
    for (float& channel : colour) channel = 0.25F + 0.7F * channel;
    return colour;
}

}  // namespace palpate
