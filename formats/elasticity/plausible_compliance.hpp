// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "formats/model/body.hpp"

namespace palpate::elasticity {

/// The contact node whose stored compliance is farthest off.
struct WorstAnswer {
    std::size_t contact_node = 0;
    double difference = 0;    ///< mm, of its displacements by C and by the mesh, over all loads
    double displacement = 0;  ///< mm, by the mesh

    /// Infinite where C answers with no number.
    double part() const;
};

/// What part() of a sound compliance stays below: in 400 draws on a brain it was 0.084 at most
/// (tests/benchmarks/README.md, "Forgers and crashes"); a hand is not hurt by a tenth.
inline constexpr double most_off = 0.1;

/// Compares a stored compliance C with mesh, materials and fixed nodes: K u = f is solved by conjugate
/// gradients for two random loads f on all contact nodes, and u at each contact node compared with C f; if a
/// node is off by more than most_off, eight other loads, solved further, decide. A node is held against its
/// own displacement, so that none hides another. Finds another modulus, boundary or mesh, another row or
/// column of C, and an entry that outweighs its row; a change of a tenth or two that one draw misses the next
/// may find. None if the gradients do not converge in 20 000 steps: an organ of 1900 contact nodes takes 550,
/// with Poisson's ratios up to 0.4999 seven times as many, and 55 of quadratic elements (see TwoLevels).
///
/// `seed` draws the loads. Unchecked: what the asset's reader checks. Cost: assembly and as many products
/// with K; in doubt some six times as many again. Source: Hestenes and Stiefel 1952.
std::optional<WorstAnswer> worst_answer(const DeformableBody& body, std::uint64_t seed);

/// Throws InvalidInput, naming the compliance by `where`, if the worst answer is off by more than most_off or
/// cannot be had. A reader of strangers' files takes another seed each time, so that nobody can make a C for
/// these loads alone.
void require_answers_of_mesh(const DeformableBody& body, const std::string& where, std::uint64_t seed);

}  // namespace palpate::elasticity
