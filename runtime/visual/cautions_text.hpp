// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <span>
#include <string>

namespace palpate::visual {

/// What a case's cautions say, for the window: one below the other, in lines of at most `width` characters;
/// empty where there are none.
std::string cautions_text(std::span<const std::string> cautions, std::size_t width);

}  // namespace palpate::visual
