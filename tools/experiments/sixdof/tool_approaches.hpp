// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "runtime/haptics/haptic_model.hpp"
#include "tools/experiments/puncture/approaches.hpp"
#include "tools/experiments/sixdof/fcl_judge.hpp"

namespace palpate::experiments {

/// What came of fast approaches of a whole tool.
struct ToolApproaches {
    std::int64_t count = 0, began_inside = 0;  ///< of these nothing else is counted
    std::int64_t beyond =
        0;  ///< whose tool ends more than 5 mm below the surface: through a gap, or through bone
    std::int64_t through =
        0;                 ///< whose core went through bone in a tick: centres of spheres that fill the tool
    std::int64_t met = 0;  ///< whose surface met the bone's at the end of a tick, by FCL
    std::int64_t unsolved = 0;  ///< with a tick that contact was not solved in
};

/// Drives a tool `count` times at 50 to 1 000 mm/s, turning at up to 20 rad/s, to 10 mm below one of the
/// places, and looks at every tick. One model for each thread; what comes out does not depend on their
/// number. `core`: points of the tool, in its frame, mm. Progress goes from 0 to 1.
ToolApproaches approach_with_tool(std::span<const std::unique_ptr<haptics::HapticModel>> models,
                                  const FclJudge& judge, std::span<const Eigen::Vector3d> core,
                                  std::span<const Place> places, std::int64_t count, std::mt19937_64& random,
                                  const std::function<void(double)>& progress);

}  // namespace palpate::experiments
