// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "formats/elasticity/stiffness.hpp"
#include "formats/model/body.hpp"
#include "tools/fem/solvers/sparse_cholesky.hpp"

namespace palpate::fem {

/// The order of a body's free nodes in its stiffness matrix.
enum class NodeOrder {
    as_numbered,        ///< as the discretisation numbers them
    nested_dissection,  ///< METIS over all free nodes
    surface_last,       ///< METIS over the interior, then the contact nodes
};

/// The stiffness of a body's free nodes.
struct FreeSystem {
    elasticity::LowerSparse stiffness;           ///< lower triangle, 3n x 3n, N/mm
    std::vector<std::int32_t> position_of_node;  ///< of each node of the discretisation; -1 for fixed ones
    std::vector<std::int64_t> contact_rows;      ///< row of x, y, z of contact node 0, then of 1, ...
};

/// Assembles mesh, materials, element order and fixed nodes. Throws as discretise() and assemble_stiffness().
FreeSystem assemble_free_system(const DeformableBody& body, NodeOrder order);

/// Factorises the system's stiffness; throws InvalidInput naming the node where it is not positive definite.
SparseCholesky factorise(const DeformableBody& body, const FreeSystem& system, Elimination elimination);

}  // namespace palpate::fem
