// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "formats/model/tet_mesh.hpp"
#include "formats/model/triangle_mesh.hpp"

namespace palpate::meshing {

/// What keeps a triangle surface from being the boundary of a body, and its size.
struct SurfaceQuality {
    std::int64_t degenerate_triangles = 0;  ///< with a repeated vertex or no area
    std::int64_t open_edges = 0;            ///< edges of one triangle only
    std::int64_t non_manifold_edges = 0;    ///< edges of more than two triangles
    std::int64_t misoriented_edges = 0;     ///< edges that two triangles run along in the same direction
    std::int64_t components = 0;            ///< pieces connected through vertices
    double area = 0;                        ///< mm²
    double volume = 0;                      ///< mm³, positive if triangles face outwards; sound if closed

    bool closed_and_oriented() const {
        return degenerate_triangles + open_edges + non_manifold_edges + misoriented_edges == 0 && volume > 0;
    }
};

/// Measures a surface. Cost: O(n log n).
SurfaceQuality measure(const TriangleMesh& surface);

/// The volume that a region's tetrahedra fill.
struct RegionVolume {
    std::int32_t region = 0;  ///< label value
    double volume = 0;        ///< mm³
};

/// One of the flattest tetrahedra.
struct WorstTetrahedron {
    std::int32_t tetrahedron = 0;
    double min_dihedral_deg = 0, max_dihedral_deg = 0;   ///< over its six angles
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< p_P, mm
};

struct MeshQuality {
    double min_dihedral_deg = 0, max_dihedral_deg = 0;  ///< over all six angles of all tetrahedra
    /// Percentiles 1, 5, 50, 95 and 99 of all dihedral angles, degrees.
    std::array<double, 5> dihedral_percentiles_deg{};
    std::array<std::int64_t, 18> dihedral_histogram{};  ///< counts in steps of 10°
    double min_radius_ratio = 0,
           mean_radius_ratio = 0;              ///< 3 inradius / circumradius: 1 is regular, 0 is flat
    std::vector<WorstTetrahedron> worst;       ///< up to five, flattest first
    std::vector<RegionVolume> region_volumes;  ///< ascending by region
    std::int64_t inverted = 0;                 ///< tetrahedra without positive volume
    std::int64_t components = 0;               ///< pieces connected through faces
    SurfaceQuality boundary;                   ///< of boundary_surface(mesh)
};

/// The shape of one tetrahedron.
struct TetShape {
    /// The angle inside, 0 ... 180, between the faces opposite to corners i and j: (0, 1), (0, 2), ... (2,
    /// 3).
    std::array<double, 6> dihedral_deg{};
    double radius_ratio = 0;  ///< 3 inradius / circumradius: 1 regular, 0 flat or inverted
};

/// Measures tetrahedron `t`. Source of both formulas: Shewchuk, "What is a good linear element?", 2002.
TetShape tet_shape(const TetMesh& mesh, std::size_t t);

/// Measures a tetrahedral mesh of one tetrahedron or more. Cost: O(n log n), 0.1 s for 50 000 tetrahedra.
MeshQuality measure(const TetMesh& mesh);

/// Returns how far the dihedral angles of tetrahedron `t` stay from 0° and 180° at least, degrees.
double flatness_deg(const TetMesh& mesh, std::size_t t);

/// How long edges are, each counted once, mm.
struct EdgeLengths {
    double shortest = 0, mean = 0, longest = 0;
};

/// Measures the edges of a mesh of one cell or more. Cost: O(n log n).
EdgeLengths edge_lengths(const TetMesh& mesh);
EdgeLengths edge_lengths(const TriangleMesh& surface);

/// Numbers the pieces of a mesh that are connected through faces: one entry per tetrahedron, pieces in order
/// of their first tetrahedron.
std::vector<std::int32_t> face_components(const TetMesh& mesh);

}  // namespace palpate::meshing
