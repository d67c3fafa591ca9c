// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace palpate::visual {

/// A connection of our own to the X display: VTK aborts where none answers, and a server that loses its last
/// client between a test and the window would start anew.
class DisplayConnection {
  public:
    /// Throws SystemFailure if no display answers.
    DisplayConnection();
    DisplayConnection(const DisplayConnection&) = delete;
    DisplayConnection& operator=(const DisplayConnection&) = delete;
    ~DisplayConnection();

  private:
    void* display_;  // a Display*, whose header has names for everything
};

/// From now on the process survives it where the X server of this display (a Display*) goes away, or the
/// connection to it, or a window of ours that another program destroys. Xlib would end the process on the
/// spot, with a force on the hand and nothing kept. Afterwards its calls do nothing. Once in a process, in
/// the thread that draws.
void survive_loss_of(void* display);

/// Whether that has happened: nothing is shown any more, and what draws must not be destroyed, which would
/// speak to the server. In the thread that draws.
bool display_lost();

/// Throws SystemFailure if it has.
void require_display();

/// Runs what draws or reads pixels, in the thread that draws; nothing once the display is lost. Is left on
/// the spot where the connection goes meanwhile, without destroying what the speech holds: Mesa's software
/// renderer (22.3) smashed its stack where it went on after that. So a speech holds no lock of ours.
void speak_to_display(const std::function<void()>& speech);

}  // namespace palpate::visual
