// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/display_loss.hpp"

#include <X11/Xlib.h>

namespace palpate::visual {
namespace {

bool lost = false;

int note_loss(Display*, XErrorEvent*) {
    lost = true;
    return 0;
}

}  // namespace

void survive_loss_of(void* display) {
    XSetErrorHandler(note_loss);
    XSetIOErrorHandler([](Display*) { return 0; });  // Xlib's own writes to stderr
    XSetIOErrorExitHandler(
        static_cast<Display*>(display), [](Display*, void*) { lost = true; }, nullptr);
}

bool display_lost() {
    return lost;
}

}  // namespace palpate::visual
