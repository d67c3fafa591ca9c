// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string_view>

namespace palpate::visual {

/// A key that does something in the window whatever is going on, and the button that does the same.
struct WindowKey {
    std::string_view key;  ///< X11 name, lower case
    const char* label;     ///< in English, on its button
    const char* tip;       ///< in English, what it does, beside the button that the pointer rests on
    bool of_jaws = false;  ///< only where a forceps is held
};

/// All of them, in the order of their buttons. Help, tips and buttons follow this table; a new key is a line
/// here and one where it acts: in TrainWindow what is the window's own, in the program what is not.
std::span<const WindowKey> window_keys();

}  // namespace palpate::visual
