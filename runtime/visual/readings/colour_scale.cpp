// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/readings/colour_scale.hpp"

#include <cmath>
#include <vtkProperty2D.h>
#include <vtkRenderWindow.h>
#include <vtkTextProperty.h>

#include "runtime/visual/overlay.hpp"
#include "runtime/visual/screen_text.hpp"

namespace palpate::visual {

ColourScale::ColourScale(vtkScalarsToColors* colours, const std::string& title, double left,
                         vtkRenderer* front)
    : front_(front) {
    bar_->SetLookupTable(colours);
    bar_->SetTitle(title.c_str());
    bar_->SetVerticalTitleSeparation(8);
    bar_->SetNumberOfLabels(5);
    bar_->SetLabelFormat("%.3g");
    bar_->UnconstrainedFontSizeOn();
    bar_->SetPosition(left, 0.2);
    bar_->SetWidth(0.075);
    bar_->SetHeight(0.36);
    bar_->DrawBackgroundOn();
    bar_->GetBackgroundProperty()->SetColor(0.05, 0.07, 0.09);
    bar_->GetBackgroundProperty()->SetOpacity(0.55);
    for (vtkTextProperty* text : {bar_->GetTitleTextProperty(), bar_->GetLabelTextProperty()}) {
        dress(text, 0);
        text->ItalicOff();
        text->ShadowOff();
        text->BoldOff();
    }
    bar_->VisibilityOff();
    front->AddActor2D(bar_);
}

void ColourScale::show(bool on) {
    bar_->SetVisibility(on);
}

void ColourScale::fit() {
    constexpr double points = 14;  // in a window of 1280x720
    const int* size = front_->GetVTKWindow()->GetSize();
    const auto font = static_cast<int>(std::lround(points * display_scale(size[0], size[1])));
    for (vtkTextProperty* text : {bar_->GetTitleTextProperty(), bar_->GetLabelTextProperty()})
        text->SetFontSize(font);
}

}  // namespace palpate::visual
