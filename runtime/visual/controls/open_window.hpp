// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>

namespace palpate::visual {

struct OpenedWindow;  // controls/opened_window.hpp

/// Width and height, pixels.
using WindowSize = std::array<int, 2>;

/// That of a window on a display of so many pixels: two thirds of 1920x1080, more where there is more, and
/// all of a display that has less.
WindowSize usual_window_size(int display_width, int display_height);

/// Opens an empty window that says what is waited for: display and graphics begin while another thread still
/// reads the case. `size`: if not given, as usual_window_size() of the display. Throws SystemFailure if no X
/// display answers.
std::shared_ptr<OpenedWindow> open_window(const std::optional<WindowSize>& size, const std::string& sentence);

}  // namespace palpate::visual
