// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/body.hpp"

namespace palpate::fem {

/// Estimates how much the elements miss: the median over random contact loads of 1 - W / W', where W is the
/// work of the load on the body's own elements and W' that on richer ones, which contain them: quadratic
/// tetrahedra on the same mesh for linear ones, quadratic ones on the mesh refined once for quadratic ones.
/// By Galerkin orthogonality 1 - W / W' is the squared energy norm of the difference of both solutions over
/// that of the richer one, in [0, 1]. Loads are tractions that are linear on the surface triangles, because
/// forces on single nodes yield ever more under refinement. Reads mesh, materials, element order, fixed and
/// contact nodes, boundary. Cost: a factorisation with about 8 times the unknowns.
double estimate_discretisation_error(const DeformableBody& body);

}  // namespace palpate::fem
