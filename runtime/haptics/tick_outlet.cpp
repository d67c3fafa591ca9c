// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/tick_outlet.hpp"

namespace palpate::haptics {

using namespace realtime;

TickOutlet::TickOutlet(std::size_t tools, std::size_t ring_capacity) : ring_(ring_capacity) {
    for (std::size_t t = 0; t < tools; ++t) latest_.push_back(std::make_unique<TripleBuffer<TickResult>>());
}

void TickOutlet::publish(std::span<const TickResult> results) noexcept {
    for (std::size_t t = 0; t < results.size(); ++t) {
        copy_active(results[t], latest_[t]->back());
        latest_[t]->publish();
        ring_.fill([&](TickResult& slot) { copy_active(results[t], slot); });
    }
}

}  // namespace palpate::haptics
