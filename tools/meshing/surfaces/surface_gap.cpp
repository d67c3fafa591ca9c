// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/surfaces/surface_gap.hpp"

namespace palpate::meshing {

std::optional<double> surface_gap(const SmoothedLabels& labels, const InterfaceSide& side,
                                  const Eigen::Vector3d& p_P, double reach) {
    const std::uint8_t here = labels.region_at(p_P);
    if (here != side.inner && here != side.outer) return std::nullopt;
    const Eigen::Vector3d ahead = here == side.inner ? side.normal : Eigen::Vector3d(-side.normal);
    const double step = 0.5 * labels.grid().spacing.minCoeff();
    double before = 0, beyond = step;
    while (labels.region_at(p_P + beyond * ahead) == here) {
        if (beyond > reach) return std::nullopt;
        before = beyond;
        beyond += step;
    }
    for (int halving = 0; halving < 7; ++halving) {
        const double middle = 0.5 * (before + beyond);
        (labels.region_at(p_P + middle * ahead) == here ? before : beyond) = middle;
    }
    const double distance = 0.5 * (before + beyond);
    return here == side.inner ? distance : -distance;
}

}  // namespace palpate::meshing
