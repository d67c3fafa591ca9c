// SPDX-License-Identifier: Apache-2.0
#include "formats/toml_file/parse_file.hpp"

#include <fmt/format.h>

#include "formats/model/errors.hpp"

namespace palpate::toml_file {

toml::table parse_file(const std::filesystem::path& path, const std::string& next_step) {
    try {
        return toml::parse_file(path.string());
    } catch (const toml::parse_error& error) {
        const auto line = error.source().begin.line;
        throw InvalidInput({line > 0 ? fmt::format("{}:{}", path.string(), line) : path.string(),
                            std::string(error.description()), "", next_step});
    }
}

}  // namespace palpate::toml_file
