// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/haptics/contact/load_spread.hpp"

namespace palpate::test {

/// A contact point as palpate touch reports it: mesh nodes with weights, unit normal from tissue to what
/// presses it, the tool or a rigid body beside it.
struct DirectContact {
    std::vector<std::int32_t> nodes;
    std::vector<double> weights;
    Eigen::Vector3d normal;
    double series_compliance;  // mm/N
    bool of_tool = true;
};

/// The same contact with its load spread over the mesh as the tick spreads it.
DirectContact spread_over(const DeformableBody& body, const haptics::LoadSpread& spread,
                          const DirectContact& contact);

/// A_kl of the contact points of one tool and of rigid neighbours from the full sparse stiffness, without the
/// condensed compliance; the tool is behind a virtual coupling of `coupling_stiffness` (N/mm): mm/N.
Eigen::MatrixXd direct_compliance(const DeformableBody& body, const std::vector<DirectContact>& contacts,
                                  double coupling_stiffness);

/// Solves A f = delta on the points with `active`, zero elsewhere.
Eigen::VectorXd direct_forces(const Eigen::MatrixXd& A, const Eigen::VectorXd& delta,
                              const std::vector<bool>& active);

}  // namespace palpate::test
