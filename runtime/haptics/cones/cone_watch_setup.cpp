// SPDX-License-Identifier: Apache-2.0
// What a watch by normal cones allocates.
#include "runtime/haptics/cones/cone_watch.hpp"

namespace palpate::haptics {

ConeWatch::ConeWatch(const collision::NormalConeTree& tool, std::span<const collision::NormalConeTree> bodies,
                     double reach)
    : GapWatch(reach, most_touches, tool.longest_arm()),
      tool_(tool),
      bodies_(bodies),
      around_{.slack = {.way = 0.3, .turn = 0.006}, .items = std::vector<Kept>(most_kept)},
      closer_{.slack = {.way = 0.05, .turn = 0.003}, .items = std::vector<std::size_t>(most_kept)} {}

ConeWatch::~ConeWatch() = default;

}  // namespace palpate::haptics
