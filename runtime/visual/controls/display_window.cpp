// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/display_window.hpp"

#include <X11/Xlib.h>
#include <vtkObjectFactory.h>

#include "runtime/visual/controls/display.hpp"

namespace palpate::visual {

vtkStandardNewMacro(DisplayWindow);

void DisplayWindow::TextureDepthBlit(vtkTextureObject* /*depth*/) {}

void DisplayWindow::SetSize(int width, int height) {
    if (!display_lost()) Superclass::SetSize(width, height);
}

void DisplayWindow::BlitDisplayFramebuffersToHardware() {
    XWindowAttributes attributes;  // asking for them notes the loss
    XGetWindowAttributes(static_cast<Display*>(GetGenericDisplayId()),
                         reinterpret_cast<Window>(GetGenericWindowId()), &attributes);
    if (!display_lost()) Superclass::BlitDisplayFramebuffersToHardware();
}

}  // namespace palpate::visual
