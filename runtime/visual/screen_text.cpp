// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/screen_text.hpp"

namespace palpate::visual {

void dress(vtkTextProperty* text, double sheet_opacity) {
    text->SetFontFamilyToArial();
    text->SetColor(0.93, 0.95, 0.97);
    text->SetBackgroundColor(0.05, 0.07, 0.09);
    text->SetBackgroundOpacity(sheet_opacity);
}

}  // namespace palpate::visual
