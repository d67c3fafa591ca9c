// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <array>
#include <string>

#include "formats/model/body.hpp"
#include "tools/fem/certificate/contact_loads.hpp"

namespace palpate::fem {

/// 1 N along x, y and z, spread evenly over the contact nodes. Reads contact_nodes.
std::array<ContactLoad, 3> spread_newtons(const DeformableBody& body);

/// How far 0.1 N spread evenly over a body moves what goes farthest, mm, and where that is, p_P.
struct Sway {
    double distance = 0;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
};

/// `displacements` answer to spread_newtons(), a row for each, x, y, z of every contact node in mm.
Sway sway_of(const DeformableBody& body, const Eigen::MatrixXd& displacements);

/// The same by the body's own compliance.
Sway sway_of(const DeformableBody& body);

/// Whether a body goes by more than a quarter of its extent: it is held at one end, or hangs by a thread, and
/// linear elasticity says nothing of it.
bool hangs(const DeformableBody& body, const Sway& sway);

/// "hangs: 0.1 N ...", to follow the body's name.
std::string hanging_text(const Sway& sway);

}  // namespace palpate::fem
