// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vtkNew.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include "runtime/visual/controls/display.hpp"
#include "runtime/visual/controls/display_window.hpp"

namespace palpate::visual {

/// A window on the screen and what draws in it.
struct OpenedWindow {
    DisplayConnection display;
    vtkNew<vtkRenderer> renderer, front;  ///< the scene, and what is drawn over it
    vtkNew<DisplayWindow> window;
    vtkNew<vtkRenderWindowInteractor> interactor;
};

}  // namespace palpate::visual
