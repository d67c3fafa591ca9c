// SPDX-License-Identifier: Apache-2.0
#include "formats/toml_file/quoted.hpp"

#include <fmt/format.h>

namespace palpate::toml_file {

std::string quoted(const std::string& text) {
    std::string escaped = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') escaped += '\\';
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            escaped += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
        else
            escaped += c;
    }
    return escaped + '"';
}

}  // namespace palpate::toml_file
