// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vtkTextProperty.h>

namespace palpate::visual {

/// Gives a text over the scene the window's font and colours, on a dark sheet of that opacity, 0 ... 1.
void dress(vtkTextProperty* text, double sheet_opacity);

}  // namespace palpate::visual
