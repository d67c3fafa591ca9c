// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/html.hpp"

#include <fmt/format.h>

namespace palpate::report::html {

std::string data_uri(std::string_view media_type, std::string_view bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string result = fmt::format("data:{};base64,", media_type);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8 | (k < have ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
        for (std::size_t k = 0; k < 4; ++k) result += k <= have ? digits[group >> (18 - 6 * k) & 63U] : '=';
    }
    return result;
}

std::string table(const std::vector<Column>& columns, const std::vector<std::vector<std::string>>& rows) {
    std::string result = "<div class=\"scroll\"><table>\n<thead><tr>";
    for (const Column& column : columns)
        result += fmt::format("<th{}>{}</th>", column.numeric ? " class=\"n\"" : "", escaped(column.title));
    result += "</tr></thead>\n<tbody>\n";
    for (const auto& row : rows) {
        result += "<tr>";
        for (std::size_t i = 0; i < row.size(); ++i)
            result += fmt::format("<td{}>{}</td>", columns[i].numeric ? " class=\"n\"" : "", row[i]);
        result += "</tr>\n";
    }
    return result + "</tbody></table></div>\n";
}

std::string cards(const std::vector<Card>& cards) {
    std::string result = "<dl class=\"cards\">\n";
    for (const Card& card : cards)
        result += fmt::format("<div><dt>{}</dt><dd>{}{}</dd></div>\n", card.name, card.value,
                              card.unit.empty() ? "" : " <small>" + card.unit + "</small>");
    return result + "</dl>\n";
}

std::string section(std::string_view anchor, std::string_view title, std::string_view lead,
                    std::string_view content) {
    return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}{}</section>\n", anchor, escaped(title),
                       lead.empty() ? "" : fmt::format("<p class=\"lead\">{}</p>\n", lead), content);
}

std::string figure(std::string_view content, std::string_view caption) {
    return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", content, caption);
}

std::string missing(std::string_view text) {
    return fmt::format("<p class=\"missing\">{}</p>\n", text);
}

std::string grouped(std::int64_t value) {
    std::string digits = std::to_string(value);
    const std::size_t first = digits.front() == '-' ? 1 : 0;
    for (std::size_t at = digits.size(); at > first + 3;) digits.insert(at -= 3, "\u202f");
    return digits;
}

std::string significant(double value, int digits) {
    return fmt::format("{:.{}g}", value, digits);
}

}  // namespace palpate::report::html
