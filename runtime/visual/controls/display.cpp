// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/display.hpp"

#include <X11/Xlib.h>
#include <csetjmp>
#include <csignal>

#include "formats/model/errors.hpp"

namespace palpate::visual {
namespace {

bool lost = false;
std::jmp_buf* way_out = nullptr;  // of the speech that is under way

int note_loss(Display*, XErrorEvent*) {
    lost = true;
    return 0;
}

void leave(Display*, void*) {
    lost = true;
    if (way_out != nullptr) std::longjmp(*way_out, 1);
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
    std::signal(SIGPIPE, SIG_IGN);  // of what is still written to it
    XSetErrorHandler(note_loss);
    XSetIOErrorHandler([](Display*) { return 0; });  // Xlib's own writes to stderr
    XSetIOErrorExitHandler(static_cast<Display*>(display), leave, nullptr);
}

bool display_lost() {
    return lost;
}

void require_display() {
    if (lost)
        throw SystemFailure({.culprit = "DISPLAY",
                             .found = "display or window went away",
                             .expected = "",
                             .next_step = "start again where a display answers"});
}

void speak_to_display(const std::function<void()>& speech) {
    if (lost) return;
    std::jmp_buf here;
    if (setjmp(here) != 0) {
        way_out = nullptr;
        return;
    }
    way_out = &here;
    try {
        speech();
    } catch (...) {
        way_out = nullptr;
        throw;
    }
    way_out = nullptr;
}

}  // namespace palpate::visual
