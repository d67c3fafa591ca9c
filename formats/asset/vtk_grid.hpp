// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "formats/asset/hdf5/hdf5_writer.hpp"
#include "formats/model/body.hpp"

namespace palpate::asset {

/// Writes group /VTKHDF: all bodies as one unstructured grid, rigid surfaces as triangles, deformable bodies
/// as tetrahedra, in the order of the case. Source: VTK file formats, "VTKHDF file format", version 1.0.
void write_vtk_grid(Hdf5Writer& writer, const Case& patient_case);

/// Compares group /VTKHDF of a file with the case that was read from it, but for the texts of variable length
/// that no reader may rely on. Returns the dataset that shows something else; none if all are as
/// write_vtk_grid() writes them. Throws InvalidInput as Hdf5File does.
std::optional<std::string> vtk_grid_difference(const std::filesystem::path& path, const Case& patient_case);

}  // namespace palpate::asset
