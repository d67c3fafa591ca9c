// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/overrides.hpp"

#include "formats/model/errors.hpp"

namespace palpate::case_builder {

Override parse_override(const std::string& text, const std::filesystem::path& file, int line) {
    const std::size_t sign = text.find('=');
    if (sign == 0 || sign == std::string::npos)
        throw UsageError({text, "sets nothing", "KEY=VALUE, such as haptics.tool_radius_mm=2", ""});
    return {text.substr(0, sign), text.substr(sign + 1), file, line};
}

}  // namespace palpate::case_builder
