// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "runtime/haptics/contact/deformable_contact.hpp"

namespace palpate::haptics {

/// Where neo-Hookean tissue rests under the forces f of one tick, told as what it adds to the answer C f of
/// its compliance. Fields are by surface vertex, mm.
struct LargeShape {
    explicit LargeShape(std::size_t vertices = 0) { reset(vertices); }

    void reset(std::size_t vertices) {
        work = 0;
        bend = 1;
        for (auto* field : {&moved, &beyond, &drawn}) field->assign(vertices, Eigen::Vector3f::Zero());
    }

    double work = 0;                      ///< f . u, N mm; 0: at rest
    double bend = 1;                      ///< how u - C f goes with the load, part()
    std::vector<Eigen::Vector3f> moved;   ///< u, averaged as contact feels it
    std::vector<Eigen::Vector3f> beyond;  ///< u - C f, averaged so
    std::vector<Eigen::Vector3f> drawn;   ///< u - C f

    /// How much of f's load others are: (others . u) / (f . u), within 0 ... most_load. Realtime-safe.
    template <typename Forces>
    double load_of(const Forces& forces) const noexcept {
        if (!(work > 0)) return 0;
        double along = 0;
        for (const SurfaceForce& of : forces)
            along += static_cast<double>(of.force.dot(moved[static_cast<std::size_t>(of.vertex)]));
        return std::clamp(along / work, 0.0, most_load);
    }
    /// How much of u - C f counts under a part `load` of f: all of it under f; otherwise as a function of the
    /// second order has it, for nothing is beyond C f to the first. Where tissue stiffens so much that it
    /// would give way less under more, less bent. Realtime-safe.
    double part(double load) const noexcept { return load * (1 + bend * (load - 1)); }

    static constexpr double most_load = 1.5;  ///< beyond which nothing is foretold
};

}  // namespace palpate::haptics
