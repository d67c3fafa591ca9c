// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

namespace palpate::visual {

struct OpenedWindow;  // controls/opened_window.hpp

/// Opens an empty window of so many pixels that says what is waited for: display and graphics begin while
/// another thread still reads the case. Throws SystemFailure if no X display answers.
std::shared_ptr<OpenedWindow> open_window(int width, int height, const std::string& sentence);

}  // namespace palpate::visual
