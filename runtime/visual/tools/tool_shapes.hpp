// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vtkActor.h>
#include <vtkSmartPointer.h>

#include "runtime/visual/actors.hpp"

namespace palpate::visual {

inline const Rgb held_blue(90, 170, 235), steel(150, 160, 170);  ///< a held tool's tip and shaft

/// A ball about the origin; `radius` in mm, `resolution` in corners along its equator.
vtkSmartPointer<vtkActor> ball(double radius, const Rgb& colour, int resolution);

/// A shaft from the origin along the x axis, of a tool whose tip has that radius, mm.
vtkSmartPointer<vtkActor> tool_shaft(double tip_radius, double length, const Rgb& colour);

/// The arrow of a force: from the origin along the x axis, 1 long; `width`: 1 as that of the held tool.
vtkSmartPointer<vtkActor> force_arrow(double width, const Rgb& colour);

}  // namespace palpate::visual
