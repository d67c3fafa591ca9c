// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace palpate::toml_file {

/// A text as TOML writes it on one line, in quotation marks.
std::string quoted(const std::string& text);

}  // namespace palpate::toml_file
