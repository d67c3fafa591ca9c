// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/whole_tool/gap_watch.hpp"

namespace palpate::haptics {

GapWatch::~GapWatch() = default;

}  // namespace palpate::haptics
