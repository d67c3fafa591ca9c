// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

namespace palpate::inspection {

/// Lines "name  words" whose words begin in one column.
std::string aligned(const std::vector<std::pair<std::string, std::string>>& lines);

/// A table whose columns are as wide as their widest cell: the first to the left, the others to the right;
/// the first row is the head.
std::string table(const std::vector<std::vector<std::string>>& rows);

/// "(1.0, -2.5, 3.0)".
std::string place(const Eigen::Vector3d& p_P);

/// "10.0 x 20.5 x 30.0".
std::string lengths(const Eigen::Vector3d& sizes);

}  // namespace palpate::inspection
