// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/visual/actors.hpp"
#include "runtime/visual/bodies/tissue_colours.hpp"

namespace palpate::visual {

/// Draws `data` as matter that looks so. What is wet is mottled, finely uneven and glistens, by functions of
/// the place that need no texture coordinates; `grain` (mm) is the size of the finest spots. Adds an array to
/// the points of `data` then. Where a cut shows the inside, that is flat and darker.
vtkSmartPointer<vtkActor> tissue_actor(vtkPolyData* data, const TissueLook& look, double grain);

}  // namespace palpate::visual
