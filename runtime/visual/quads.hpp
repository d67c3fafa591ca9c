// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vtkActor2D.h>
#include <vtkPoints.h>
#include <vtkRenderer.h>
#include <vtkType.h>

#include "runtime/visual/actors.hpp"

namespace palpate::visual {

/// Makes an actor draw one rectangle over a renderer, set_quad(), hidden at first.
void make_quads(vtkActor2D* actor, vtkPoints* points, const Rgb& colour, double opacity,
                vtkRenderer* renderer);

/// Gives what it draws another colour.
void set_colour(vtkActor2D* actor, const Rgb& colour);

/// Makes it draw so many, whose places are to be set then.
void set_quad_count(vtkActor2D* actor, vtkPoints* points, vtkIdType count);

/// Where one of them lies, counted from 0; pixels.
void set_quad(vtkPoints* points, vtkIdType quad, double left, double bottom, double right, double top);

}  // namespace palpate::visual
