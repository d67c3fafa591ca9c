// SPDX-License-Identifier: Apache-2.0
// Closes a window of ours as another program would, and draws in it: whether that comes to an end.
#include <X11/Xlib.h>
#include <cstdio>
#include <cstdlib>

#include "runtime/visual/controls/open_window.hpp"
#include "runtime/visual/controls/opened_window.hpp"

int main() {
    using namespace palpate;
    const auto opened = visual::open_window(visual::WindowSize{320, 240}, "");
    Display* const other = XOpenDisplay(nullptr);
    XDestroyWindow(other, reinterpret_cast<Window>(opened->window->GetGenericWindowId()));
    XSync(other, False);
    visual::speak_to_display([&] { opened->window->Render(); });
    std::puts(visual::display_lost() ? "lost" : "there");
    std::fflush(stdout);
    std::_Exit(0);  // what draws in it must not be destroyed
}
