// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "formats/model/body.hpp"

namespace palpate::elasticity {

/// Throws InvalidInput unless a stored compliance C answers loads as mesh, materials and fixed nodes do: K u
/// = f is solved by conjugate gradients for two random loads f on all contact nodes, and u at each contact
/// node compared with C f, both loads together.
///
/// A node may be off by a tenth of its own displacement, whatever the others do: sound compliances are off by
/// 0.0005 of it, and by 0.03 where they were compressed to an accuracy of 0.1. What is farther off at a node,
/// by another modulus, boundary or mesh, another row or column of C or an entry that outweighs its row, is
/// found; a change of a tenth or two that one draw misses the next may find. Where the gradients do not
/// converge in 5000 steps nothing can be said, and C is refused: a Poisson's ratio of 0.4999 takes 1400.
///
/// `seed` draws the loads. A reader of strangers' files takes another each time, so that nobody can make a C
/// that answers these loads alone. `where` names the compliance. Unchecked: what the asset's reader checks.
/// Cost: assembly and some hundred products with K, 0.4 s for 15 000 linear tetrahedra. Source: Hestenes and
/// Stiefel 1952.
void require_answers_of_mesh(const DeformableBody& body, const std::string& where, std::uint64_t seed);

}  // namespace palpate::elasticity
