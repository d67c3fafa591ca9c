// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/haptics/contact/deformable_contact.hpp"

namespace palpate::haptics {

/// Of so many ticks the forces are kept, for replays.
inline constexpr std::int64_t remembered_ticks = 1024;

/// Where the search for rest of neo-Hookean tissue has come under forces f, which follow those of the ticks;
/// told as what it adds to the answer C f of its compliance. Fields are by surface vertex, mm.
struct LargeShape {
    explicit LargeShape(std::size_t vertices = 0) { reset(vertices); }

    void reset(std::size_t vertices) {
        work = 0;
        bend = 1;
        settled = true;
        for (auto* field : {&moved, &beyond, &drawn}) field->assign(vertices, Eigen::Vector3f::Zero());
    }

    double work = 0;                      ///< f . u, N mm; 0: at rest
    double bend = 1;                      ///< how u - C f goes with the load, part()
    bool settled = true;                  ///< whether another step would hardly move it
    std::vector<Eigen::Vector3f> moved;   ///< u, averaged as contact feels it
    std::vector<Eigen::Vector3f> beyond;  ///< u - C f, averaged so
    std::vector<Eigen::Vector3f> drawn;   ///< u - C f

    /// How much of f's load other forces are, whose product with u (`moved`) is `along`, N mm: along / (f .
    /// u), within 0 ... most_load. Realtime-safe.
    double load_of(double along) const noexcept {
        return work > 0 ? std::clamp(along / work, 0.0, most_load) : 0;
    }
    /// How much of u - C f counts under a part `load` of f: all of it under f; otherwise as a function of the
    /// second order has it, for nothing is beyond C f to the first. Where tissue stiffens so much that it
    /// would give way less under more, less bent. Realtime-safe.
    double part(double load) const noexcept { return load * (1 + bend * (load - 1)); }

    static constexpr double most_load = 1.5;  ///< beyond which nothing is foretold
};

}  // namespace palpate::haptics
