// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vtkNew.h>
#include <vtkRenderPass.h>
#include <vtkSmartPointer.h>

class vtkOpenGLFramebufferObject;

namespace palpate::visual {

/// Draws what a renderer holds with fewer pixels than its part of the window has, and enlarges the picture to
/// fit: what covers the window costs software rendering most, and a window cannot have a size other than its
/// own. Texts stay sharp in a renderer of their own. To be set as a renderer's pass.
class CoarsePixels : public vtkRenderPass {
  public:
    static CoarsePixels* New();
    vtkTypeMacro(CoarsePixels, vtkRenderPass);

    /// How many pixels of the window one that is drawn takes along each side, 2 or more, and whether what
    /// lies between is blended.
    void set(int pixels, bool smooth) {
        size_ = pixels;
        smooth_ = smooth;
    }

    void Render(const vtkRenderState* state) override;
    void ReleaseGraphicsResources(vtkWindow* window) override;

  protected:
    CoarsePixels();
    ~CoarsePixels() override;

  private:
    int size_ = 2;
    bool smooth_ = true;
    vtkSmartPointer<vtkRenderPass> steps_;
    vtkSmartPointer<vtkOpenGLFramebufferObject> drawn_;
};

}  // namespace palpate::visual
