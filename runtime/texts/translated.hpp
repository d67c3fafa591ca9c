// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>
#include <string>
#include <string_view>

namespace palpate::texts {

/// Lets texts follow the desktop's language (LANGUAGE, LC_ALL, LC_MESSAGES, LANG) from now on, as far as the
/// catalogues in `share/palpate/locale` beside the program's folder go. Numbers keep their decimal point.
/// Once, before threads.
void follow_the_desktop();

/// An English text in the desktop's language, or as it is. `english` ends with a zero byte.
std::string_view looked_up(const char* english);

/// The same of a format and its values, whose English is checked when it is compiled. A translation whose
/// fields do not fit is not used.
template <typename... Args>
std::string translated(fmt::format_string<const Args&...> english, const Args&... args) {
    const fmt::string_view format = english;
    const std::string_view here = looked_up(format.data());
    const auto values = fmt::make_format_args(args...);
    try {
        return fmt::vformat(fmt::string_view(here.data(), here.size()), values);
    } catch (const fmt::format_error&) {
        return fmt::vformat(format, values);
    }
}

}  // namespace palpate::texts
