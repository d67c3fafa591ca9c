// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/window_keys.hpp"

#include <array>

namespace palpate::visual {

std::span<const WindowKey> window_keys() {
    static constexpr auto table = std::to_array<WindowKey>({
        {"c", "Cut", "cut away what hides the tool"},
        {"b", "Bone", "show or hide what does not give way"},
        {"t", "Inside", "show or hide what organs enclose, such as a tumour"},
        {"x", "Slices", "the scan's slice through the tool: axial, coronal, sagittal, none"},
        {"v", "Tip", "look from the tool's tip, then in a corner too, then not"},
        {"u", "Undo", "the view before the last turn, shift or zoom"},
        {"r", "Start", "tool and view back to where they began"},
        {"p", "Picture", "save a picture of the window in this folder"},
        {"o", "Record", "record every tick in this folder from now on, or stop"},
        {"a", "Audio", "hear the force: the harder, the higher"},
        {"f", "Scheme", "find contact in the next way, published or ours"},
        {"i", "About", "how this case was made"},
        {"h", "Help", "show or hide what the mouse does"},
        {"q", "Quit", "close the window"},
    });
    return table;
}

}  // namespace palpate::visual
