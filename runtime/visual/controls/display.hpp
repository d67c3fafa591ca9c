// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::visual {

/// From now on the process survives it where the X server of this display (a Display*) goes away, or the
/// connection to it, or a window of ours that another program destroys. Xlib would end the process on the
/// spot, with a force on the hand and nothing kept. Afterwards its calls do nothing. Once in a process, in
/// the thread that draws.
void survive_loss_of(void* display);

/// Whether that has happened: nothing is shown any more, and what draws must not be destroyed, which would
/// speak to the server. In the thread that draws.
bool display_lost();

}  // namespace palpate::visual
