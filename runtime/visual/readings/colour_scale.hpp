// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vtkNew.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkScalarsToColors.h>

namespace palpate::visual {

/// A bar that says which number a colour means, hidden at first.
class ColourScale {
  public:
    /// `title`: the unit. `left`: where it begins, a share of the window's width.
    ColourScale(vtkScalarsToColors* colours, const std::string& title, double left, vtkRenderer* front);

    void show(bool on);
    /// Sizes follow the window.
    void fit();

  private:
    vtkRenderer* front_;
    vtkNew<vtkScalarBarActor> bar_;
};

}  // namespace palpate::visual
