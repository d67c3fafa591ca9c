// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "formats/model/body.hpp"

namespace palpate::elasticity {

/// Throws InvalidInput unless a stored compliance C answers a load as mesh, materials and fixed nodes do: K u
/// = f is solved by conjugate gradients for a random load f on all contact nodes, and u at the contact nodes
/// compared with C f, node by node.
///
/// A node may differ by a tenth of its displacement and a hundredth of all nodes' root mean square together:
/// far above what rounding, compression and the solver's own tolerance make, and below what could hurt a
/// hand. An entry that is off by a fifth of its row's norm stands out, and so does any change of modulus,
/// boundary or mesh that matters. Where the gradients do not converge, as Poisson's ratios near 0.5 may make
/// them, their work from below is what is left to compare: the load may do no less on C.
///
/// The load is drawn anew at every call, so that nobody can make a C that answers it alone. `where` names the
/// compliance. Unchecked: what the asset's reader checks. Cost: assembly and some hundred products with K,
/// 0.2 s for 15 000 linear tetrahedra. Source: Hestenes and Stiefel 1952.
void require_answers_of_mesh(const DeformableBody& body, const std::string& where);

}  // namespace palpate::elasticity
