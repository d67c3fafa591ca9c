// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/inspection/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace palpate::inspection {
namespace {

// Characters of UTF-8, not bytes.
std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string padding(const std::string& text, std::size_t width) {
    return std::string(width - std::min(width, width_of(text)), ' ');
}

}  // namespace

std::string aligned(const std::vector<std::pair<std::string, std::string>>& lines) {
    std::size_t width = 0;
    for (const auto& [name, words] : lines) width = std::max(width, width_of(name));
    std::string text;
    for (const auto& [name, words] : lines)
        text += words.empty() ? name + "\n" : name + padding(name, width) + "  " + words + "\n";
    return text;
}

std::string table(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths(rows.front().size(), 0);
    for (const auto& row : rows)
        for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width_of(row[c]));
    std::string text;
    for (const auto& row : rows) {
        text += row[0] + padding(row[0], widths[0]);
        for (std::size_t c = 1; c < row.size(); ++c) text += "  " + padding(row[c], widths[c]) + row[c];
        text += "\n";
    }
    return text;
}

std::string place(const Eigen::Vector3d& p_P) {
    return fmt::format("({:.1f}, {:.1f}, {:.1f})", p_P.x(), p_P.y(), p_P.z());
}

std::string lengths(const Eigen::Vector3d& sizes) {
    return fmt::format("{:.1f} x {:.1f} x {:.1f}", sizes.x(), sizes.y(), sizes.z());
}

}  // namespace palpate::inspection
