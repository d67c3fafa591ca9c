// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/window_keys.hpp"

#include <array>

#include "formats/records/shown_text.hpp"

namespace palpate::visual {

std::span<const WindowKey> window_keys() {
    static constexpr auto table = std::to_array<WindowKey>({
        {"c", shown_text("Cut"), shown_text("cut away what hides the tool")},
        {"b", shown_text("Bone"), shown_text("show or hide what does not give way")},
        {"t", shown_text("Inside"), shown_text("show or hide what organs enclose, such as a tumour")},
        {"x", shown_text("Slices"),
         shown_text("the scan's slice through the tool: axial, coronal, sagittal, none")},
        {"g", shown_text("Map"), shown_text("colour the surface by how stiff it is under the case's ball")},
        {"v", shown_text("Tip"), shown_text("look from the tool's tip, then in a corner too, then not")},
        {"j", shown_text("Jaws"), shown_text("close the jaws, or open them"), true},
        {"u", shown_text("Undo"), shown_text("the view before the last turn, shift or zoom")},
        {"r", shown_text("Start"), shown_text("tool and view back to where they began")},
        {"p", shown_text("Picture"), shown_text("save a picture of the window in this folder")},
        {"o", shown_text("Record"), shown_text("record every tick in this folder from now on, or stop")},
        {"a", shown_text("Audio"), shown_text("hear the force: the harder, the higher")},
        {"f", shown_text("Scheme"), shown_text("find contact in the next way, published or ours")},
        {"i", shown_text("About"), shown_text("how this case was made")},
        {"h", shown_text("Help"), shown_text("show or hide what the mouse does")},
        {"q", shown_text("Quit"), shown_text("close the window")},
    });
    return table;
}

}  // namespace palpate::visual
