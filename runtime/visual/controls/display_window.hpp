// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vtkXOpenGLRenderWindow.h>

namespace palpate::visual {

/// A window on the display. With every frame VTK would copy the picture's depth into it through a shader that
/// software rendering runs on every pixel; nothing here reads it there, and this one has none. Into a window
/// that somebody else has closed nothing is drawn, which software rendering would not survive, and it gets no
/// size: VTK takes it for one that has none yet, and would wait for it for good. See display_lost().
class DisplayWindow : public vtkXOpenGLRenderWindow {
  public:
    static DisplayWindow* New();
    vtkTypeMacro(DisplayWindow, vtkXOpenGLRenderWindow);

    using vtkXOpenGLRenderWindow::TextureDepthBlit;
    void TextureDepthBlit(vtkTextureObject* depth) override;
    using vtkXOpenGLRenderWindow::SetSize;
    void SetSize(int width, int height) override;

  protected:
    void BlitDisplayFramebuffersToHardware() override;
};

}  // namespace palpate::visual
