// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "formats/model/tet_mesh.hpp"

namespace palpate::report {

/// Counts of equal bins over [low, high]; values beyond an end are counted in the end's bin.
struct BinCounts {
    double low = 0;
    double high = 1;
    std::vector<std::int64_t> counts;
};

/// A whole mesh at a glance.
struct MeshSummary {
    BinCounts dihedral_deg;  ///< all six angles of every tetrahedron, 5 degrees a bin
    BinCounts radius_ratio;  ///< one per tetrahedron, 0.05 a bin
    double min_dihedral_deg = 180;
    double max_dihedral_deg = 0;
    double min_radius_ratio = 1;
    double mean_radius_ratio = 0;
    double min_volume = 0;               ///< smallest tetrahedron, mm³
    std::vector<double> region_volumes;  ///< mm³, in the order of TetMesh::region_names
};

/// Measures every tetrahedron of a mesh with at least one; linear in their number.
MeshSummary summarise(const TetMesh& mesh);

}  // namespace palpate::report
