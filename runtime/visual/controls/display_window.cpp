// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/display_window.hpp"

#include <vtkObjectFactory.h>

namespace palpate::visual {

vtkStandardNewMacro(DisplayWindow);

void DisplayWindow::TextureDepthBlit(vtkTextureObject* /*depth*/) {}

}  // namespace palpate::visual
