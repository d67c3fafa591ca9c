// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vtkXOpenGLRenderWindow.h>

namespace palpate::visual {

/// A window on the display. With every frame VTK would copy the picture's depth into it through a shader that
/// software rendering runs on every pixel; nothing here reads it there, and this one has none. Into a window
/// that somebody else has closed nothing is drawn, which software rendering would not survive: see
/// display_lost().
class DisplayWindow : public vtkXOpenGLRenderWindow {
  public:
    static DisplayWindow* New();
    vtkTypeMacro(DisplayWindow, vtkXOpenGLRenderWindow);

    using vtkXOpenGLRenderWindow::TextureDepthBlit;
    void TextureDepthBlit(vtkTextureObject* depth) override;

  protected:
    void BlitDisplayFramebuffersToHardware() override;
};

}  // namespace palpate::visual
