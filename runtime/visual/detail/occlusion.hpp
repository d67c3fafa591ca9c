// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vtkRenderPass.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

namespace palpate::visual {

/// Draws what a renderer holds and takes light from creases and from what lies close to something else:
/// ambient occlusion in screen space, as VTK has it, within a sixteenth of the size of what is seen now.
vtkSmartPointer<vtkRenderPass> occlusion_pass(vtkRenderer* renderer);

/// Whether a graphics card draws the window, not Mesa's software. Precondition: it has been drawn.
bool drawn_by_hardware(vtkRenderWindow* window);

}  // namespace palpate::visual
