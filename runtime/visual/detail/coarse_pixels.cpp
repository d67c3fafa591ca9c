// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/detail/coarse_pixels.hpp"

#include <GL/gl.h>
#include <algorithm>
#include <vtkObjectFactory.h>
#include <vtkOpenGLFramebufferObject.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkRenderState.h>
#include <vtkRenderStepsPass.h>
#include <vtkRenderer.h>
#include <vtkTranslucentPass.h>

namespace palpate::visual {

vtkStandardNewMacro(CoarsePixels);

CoarsePixels::CoarsePixels() {
    vtkNew<vtkRenderStepsPass> steps;
    vtkNew<vtkTranslucentPass> translucent;  // what is translucent here is thin: its order is not seen
    steps->SetTranslucentPass(translucent);
    steps_ = steps;
}

CoarsePixels::~CoarsePixels() = default;

void CoarsePixels::Render(const vtkRenderState* state) {
    vtkRenderer* renderer = state->GetRenderer();
    auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
    int width = 0, height = 0, left = 0, bottom = 0;
    renderer->GetTiledSizeAndOrigin(&width, &height, &left, &bottom);
    const int columns = std::max(1, width / size_), rows = std::max(1, height / size_);

    vtkOpenGLState* gl = window->GetState();
    gl->PushFramebufferBindings();
    if (!drawn_) {
        drawn_ = vtkSmartPointer<vtkOpenGLFramebufferObject>::New();
        drawn_->SetContext(window);
        drawn_->PopulateFramebuffer(columns, rows, true, 1, VTK_UNSIGNED_CHAR, true, 24, 0);
    }
    drawn_->Resize(columns, rows);
    drawn_->Bind();
    drawn_->ActivateBuffer(0);
    drawn_->StartNonOrtho(columns, rows);
    gl->vtkglEnable(GL_DEPTH_TEST);
    vtkRenderState inner(renderer);
    inner.SetPropArrayAndCount(state->GetPropArray(), state->GetPropArrayCount());
    inner.SetFrameBuffer(drawn_);
    steps_->Render(&inner);
    NumberOfRenderedProps = steps_->GetNumberOfRenderedProps();
    gl->PopFramebufferBindings();

    gl->PushReadFramebufferBinding();
    drawn_->Bind(vtkOpenGLFramebufferObject::GetReadMode());
    drawn_->ActivateReadBuffer(0);
    const vtkOpenGLState::ScopedglScissor scissor(gl);
    gl->vtkglScissor(left, bottom, width, height);
    gl->vtkglBlitFramebuffer(0, 0, columns, rows, left, bottom, left + width, bottom + height,
                             GL_COLOR_BUFFER_BIT, smooth_ ? GL_LINEAR : GL_NEAREST);
    gl->PopReadFramebufferBinding();
}

void CoarsePixels::ReleaseGraphicsResources(vtkWindow* window) {
    steps_->ReleaseGraphicsResources(window);
    if (drawn_) drawn_->ReleaseGraphicsResources(window);
    drawn_ = nullptr;
    vtkRenderPass::ReleaseGraphicsResources(window);
}

}  // namespace palpate::visual
