// SPDX-License-Identifier: GPL-3.0-or-later
// For tools/imaging only: what the seeds of an organ say about its grey values.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/imaging/organs/organ.hpp"

namespace palpate::imaging {

constexpr double seed_radius_mm = 6;  ///< what is looked at around a seed

struct OrganSeeds {
    std::span<const Eigen::Vector3d> points;  ///< p_P, mm
    std::vector<double> means;                ///< grey value around each; NaN for a seed that does not count
    double center = 0;                        ///< median of all
};

/// Looks around each seed; a seed that no other agrees with, of three or more, is told to `note` and does not
/// count. Throws InvalidInput naming `culprit` and a seed in something darker or brighter than allowed.
OrganSeeds look_at_seeds(const Volume& volume, std::span<const Eigen::Vector3d> points,
                         const OrganParameters& p, const std::string& culprit,
                         const std::function<void(std::string_view)>& note);

/// Mean of the seeds' grey values, weighted by the inverse of their squared distance to p_P.
double expected_at(const OrganSeeds& seeds, const Eigen::Vector3d& p_P);

}  // namespace palpate::imaging
