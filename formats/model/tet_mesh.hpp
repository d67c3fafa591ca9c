// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/model/label_map.hpp"
#include "formats/model/triangle_mesh.hpp"

namespace palpate {

using Tetrahedron = std::array<std::int32_t, 4>;

/// The face opposite to each corner of a positively oriented tetrahedron, counter-clockwise from outside.
inline constexpr std::array<std::array<std::size_t, 3>, 4> tetrahedron_faces{
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// Linear tetrahedra in frame P (LPS, mm); det[p1-p0, p2-p0, p3-p0] > 0 for every one.
struct TetMesh {
    std::vector<Eigen::Vector3d> rest_positions;  ///< p_P of each node, mm
    std::vector<Tetrahedron> tetrahedra;          ///< node indices
    std::vector<std::int32_t> regions;            ///< label value per tetrahedron
    std::vector<Label> region_names;              ///< the labels that occur in `regions`, ascending by value

    /// What lies beyond the surface at each node: a label value, 0 for background, -1 for an interior node.
    /// Empty if the mesh was not made from a label map.
    std::vector<std::int32_t> outside_labels;
    /// Names of the values in `outside_labels`, background excepted.
    std::vector<Label> outside_names;
};

/// The outer boundary of a tetrahedral mesh: faces that belong to one tetrahedron only, oriented outwards.
struct BoundarySurface {
    TriangleMesh surface;
    std::vector<std::int32_t> nodes;  ///< mesh node of each surface vertex, ascending
};

/// Extracts the outer boundary; region interfaces inside the body are not part of it. Triangles come in the
/// order of their tetrahedra, so equal meshes give equal surfaces.
BoundarySurface boundary_surface(const TetMesh& mesh);

/// Unit normals of a surface's vertices, out of the body, weighted by the areas of their triangles; zero
/// where these cancel each other.
std::vector<Eigen::Vector3d> surface_normals(const TriangleMesh& surface);

/// Returns six times the signed volume of tetrahedron `t`, mm³.
double six_volume(const TetMesh& mesh, std::size_t t);

}  // namespace palpate
