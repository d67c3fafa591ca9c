// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/display.hpp"

#include <X11/Xlib.h>

#include "formats/model/errors.hpp"

namespace palpate::visual {
namespace {

bool lost = false;

int note_loss(Display*, XErrorEvent*) {
    lost = true;
    return 0;
}

}  // namespace

DisplayConnection::DisplayConnection() : display_(XOpenDisplay(nullptr)) {
    if (display_ == nullptr)
        throw SystemFailure(
            {.culprit = "DISPLAY",
             .found = "no X display answers, and the window needs one",
             .expected = "",
             .next_step = "log in to a desktop, set DISPLAY, or try 'xvfb-run palpate train ...'"});
}

DisplayConnection::~DisplayConnection() {
    XCloseDisplay(static_cast<Display*>(display_));
}

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
