// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::fem {

/// The forces of one contact.
using ContactLoad = std::vector<NodeForce>;

/// Nodes that a random contact has at most.
inline constexpr std::int32_t most_loaded_nodes = 32;

/// Makes random contacts as a tool would: each presses on 1 to most_loaded_nodes neighbouring contact nodes,
/// with forces into the body, of 0 to 1 N along the normal and up to half as much across. Reads mesh,
/// boundary and contact_nodes. The same for the same seed.
std::vector<ContactLoad> random_contact_loads(const DeformableBody& body, std::int32_t count,
                                              std::uint64_t seed);

/// Outward, of length 1, at each contact node. Reads boundary and contact_nodes.
std::vector<Eigen::Vector3d> contact_normals(const DeformableBody& body);

/// What a compliance answers to a load: the displacement of x, y, z of every contact node, mm. In double for
/// a dense matrix, since float32 sums alone would be off by as much as its limit; a hierarchical one
/// multiplies as it does at run time.
Eigen::VectorXd displacements_of(const SurfaceCompliance& compliance, const ContactLoad& load);

/// How far a compliance's answer to a load is from the exact one.
struct LoadError {
    double surface = 0;  ///< |u - u_exact| / |u_exact| over all contact nodes, Euclidean norms
    double contact = 0;  ///< the largest difference at a loaded node over the largest displacement of one
};

/// `exact` holds the exact displacement of x, y, z of every contact node, mm.
LoadError error_of(const SurfaceCompliance& compliance, const ContactLoad& load,
                   const Eigen::VectorXd& exact);

/// What error_of() may be, at most over `count` loads of `seed`, if C is right: allowed_error() of it, or
/// what rounding the entries of a dense one to float32 makes, 2^-24 sum_j |C_ij| |f_j| in place of a
/// difference, where that is more, as on thin parts whose forces nearly cancel. `found`: the worst of those
/// loads; within allowed_error() nothing is computed. Cost otherwise: 1 s for 1000 loads on 2000 nodes.
LoadError allowed_load_error(const DeformableBody& body, const LoadError& found, std::int32_t count,
                             std::uint64_t seed);

/// The part of a compliance that joins a load's nodes, 3|load| x 3|load|, mm/N.
Eigen::MatrixXd compliance_on(const SurfaceCompliance& compliance, const ContactLoad& load);

}  // namespace palpate::fem
