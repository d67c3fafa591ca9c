// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "tools/meshing/labels/smoothed_labels.hpp"

namespace palpate::meshing {

/// A triangle between two regions of SmoothedLabels, seen from `inner`.
struct InterfaceSide {
    std::uint8_t inner, outer;  ///< regions; 0 is the outside
    Eigen::Vector3d normal;     ///< unit, from inner to outer, frame P
};

/// Tells how far the labels' own surface lies from p_P along the normal, mm: positive towards the outer side,
/// within 0.5 % of the smallest voxel edge. Nothing if p_P lies in a third region or if no surface is within
/// `reach` mm. Steps of half a voxel edge: a sheet thinner than that may be stepped over.
std::optional<double> surface_gap(const SmoothedLabels& labels, const InterfaceSide& side,
                                  const Eigen::Vector3d& p_P, double reach);

}  // namespace palpate::meshing
