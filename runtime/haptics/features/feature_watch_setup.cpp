// SPDX-License-Identifier: Apache-2.0
// What a watch by closest features allocates.
#include "runtime/haptics/features/feature_watch.hpp"

namespace palpate::haptics {

FeatureWatch::FeatureWatch(const collision::ConvexPieces& tool,
                           std::span<const collision::ConvexPieces> bodies, double reach)
    : GapWatch(reach, most_found, tool.longest_arm()),
      tool_(tool),
      bodies_(bodies),
      beside_(most_beside),
      found_(most_found),
      now_(most_kept),
      before_(most_kept) {}

FeatureWatch::~FeatureWatch() = default;

}  // namespace palpate::haptics
