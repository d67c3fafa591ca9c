// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <string>
#include <string_view>

namespace palpate::meshing {

/// ASCII letters in lower case, everything else as it is, in every locale.
std::string lower_case(std::string_view text);

/// "(1.0, -2.5, 3.0)": a place in mm, for people.
std::string place_text(const Eigen::Vector3d& p_P);

}  // namespace palpate::meshing
