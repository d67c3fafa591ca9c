// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/visual/actors.hpp"
#include "runtime/visual/tissue/tissue_colours.hpp"

namespace palpate::visual {

/// Draws `data` as matter that looks so and glistens where it is wet. Where a cut shows the inside, that is
/// flat and darker.
vtkSmartPointer<vtkActor> tissue_actor(vtkPolyData* data, const TissueLook& look);

/// The same, mottled and finely uneven, by functions of the place that need no texture coordinates; `grain`
/// (mm) is the size of the finest spots. Adds an array to the points of `data`. For surfaces of few
/// triangles: in software each one costs more with it.
vtkSmartPointer<vtkActor> grained_tissue_actor(vtkPolyData* data, const TissueLook& look, double grain);

}  // namespace palpate::visual
