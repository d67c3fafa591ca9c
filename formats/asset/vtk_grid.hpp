// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/asset/hdf5/hdf5_writer.hpp"
#include "formats/model/body.hpp"

namespace palpate::asset {

/// Writes group /VTKHDF: all bodies as one unstructured grid, rigid surfaces as triangles, deformable bodies
/// as tetrahedra, in the order of the case. Source: VTK file formats, "VTKHDF file format", version 1.0.
void write_vtk_grid(Hdf5Writer& writer, const Case& patient_case);

}  // namespace palpate::asset
