// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::sample {

/// A cube [0, edge]³ mm of cells³ small cubes, six tetrahedra each; region 1 "tissue", and region 2 "tumour"
/// for the tetrahedra whose centroid lies within a quarter edge of the middle.
TetMesh cube_mesh(int cells, double edge);

/// A sphere of radius `radius` mm about `center`, from a subdivided octahedron: 8 * 4^levels triangles.
TriangleMesh sphere_surface(const Eigen::Vector3d& center, double radius, int levels);

/// A tree of axis-aligned boxes, split at the median of the longest axis down to `leaf_size` triangles.
ObbTree median_tree(const TriangleMesh& surface, std::size_t leaf_size);

/// The made-up compliance delta_ij * scale * exp(-|p_a - p_b| / length) of the given nodes: symmetric bit for
/// bit and positive definite, but not the inverse of any stiffness. `length` is in mm, `scale` in mm/N.
DenseCompliance kernel_compliance(const TetMesh& mesh, const std::vector<std::int32_t>& nodes, double length,
                                  double scale);

/// The same matrix by blocks. `order` names the contact node at each position. Clusters that follow one
/// another in it are coupled by dense blocks, all others by blocks of low rank, which leave out singular
/// values up to `accuracy` (> 0) times the matrix's largest entry: an error of at most that much per entry,
/// besides the rounding of the factors. A straight use of singular values, which owes nothing to tools/fem.
HierarchicalCompliance hierarchical(const DenseCompliance& dense, std::vector<std::int32_t> order, int depth,
                                    double accuracy);

/// The same body with its dense compliance by blocks, contact nodes in the order of x, then y, then z.
DeformableBody with_hierarchical_compliance(DeformableBody body, int depth, double accuracy);

/// An elastic cube of edge 20 mm held at z = 0, with kernel_compliance(), whose parts belong together.
DeformableBody elastic_cube(int cells);

/// A made-up stiffness of each contact node's vertex, 0.05 to 0.059 N/mm; the second region, if there is one,
/// makes half as much again of the first.
Feel made_up_feel(const DeformableBody& body, double tool_radius);

/// A made-up CT around the cube and the sphere, oblique: value = 40 i + 20 j + 10 k - 300, in HU.
Scan made_up_scan();

/// A made-up patient: a rigid sphere "skull" beside the elastic cube "wall", both in colours of their own,
/// and the scan they were made from.
Case sample_case(int cells = 2);

}  // namespace palpate::sample
