// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/model/label_map.hpp"
#include "formats/model/triangle_mesh.hpp"
#include "tools/archive/objects/reference.hpp"

namespace palpate::archive {

/// How an object is filed, and what it says of its making.
struct Filing {
    std::optional<Reference> reference;            ///< the series that it was made from
    bool identity = false;                         ///< take the reference's patient and study along
    std::string algorithm_type = "SEMIAUTOMATIC";  ///< or AUTOMATIC, MANUAL
    std::string algorithm_name = "palpate segment";
    std::string version;  ///< of the software
};

/// The label map on the axes of `reference`, or on axes whose slices lie along i x j: voxels are mirrored and
/// axes exchanged, none is interpolated, so all stay where they are in P. Throws InvalidInput if the
/// axes are not parallel within a thousandth.
LabelMap along_reference(const LabelMap& map, const Reference* reference, const std::string& culprit);

/// Writes a label map as a DICOM Segmentation (PS3.3 A.51), binary, one segment for each label in ascending
/// order, numbered from 1. The first segment has a frame on every slice, so that the grid survives; the
/// others where they occur. Positions are LPS mm as DICOM's own. The map must be as along_reference() gives
/// it. Equal input gives equal bytes. Throws InvalidInput for an empty map, a name that DICOM cannot hold or
/// a grid that is not the reference's, SystemFailure if the file cannot be written.
/// Cost: one pass a segment over the voxels.
void write_segmentation_object(const std::filesystem::path& path, const LabelMap& map, const Filing& filing,
                               const std::string& culprit);

/// Binary STL of a surface: LPS mm in float32, 84 bytes and 50 a triangle, normals by the vertices.
std::vector<unsigned char> binary_stl(const TriangleMesh& surface);

/// Writes a closed surface as a DICOM Encapsulated STL (PS3.3 A.85.1), titled `title`. Equal input gives
/// equal bytes. Throws InvalidInput if it lies outside the reference or the title is one that DICOM cannot
/// hold, SystemFailure if the file cannot be written.
void write_surface_object(const std::filesystem::path& path, const TriangleMesh& surface,
                          const std::string& title, const Filing& filing, const std::string& culprit);

}  // namespace palpate::archive
