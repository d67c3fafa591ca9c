// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "formats/drawing/markup.hpp"

namespace palpate::report::html {

using drawing::escaped;

/// "data:<media_type>;base64,..." of some bytes.
std::string data_uri(std::string_view media_type, std::string_view bytes);

struct Column {
    std::string title;     ///< escaped here
    bool numeric = false;  ///< right-aligned figures
};

/// A table; cells are HTML already, every row has one per column.
std::string table(const std::vector<Column>& columns, const std::vector<std::vector<std::string>>& rows);

/// A figure that stands out.
struct Card {
    std::string name, value, unit;  ///< HTML already
};
std::string cards(const std::vector<Card>& cards);

/// A titled section with an anchor.
std::string section(std::string_view anchor, std::string_view title, std::string_view lead,
                    std::string_view content);

/// A framed picture or chart with a caption; both are HTML already.
std::string figure(std::string_view content, std::string_view caption);

/// What a section says when its input is missing.
std::string missing(std::string_view text);

/// "12 345": thousands set apart by narrow no-break spaces.
std::string grouped(std::int64_t value);

/// `digits` significant digits, without an exponent where that reads well ("0.00012", "5.9e-08").
std::string significant(double value, int digits = 3);

}  // namespace palpate::report::html
