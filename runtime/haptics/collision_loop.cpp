// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/collision_loop.hpp"

#include "runtime/realtime/periodic_clock.hpp"

namespace palpate::haptics {

void CollisionLoop::start() {
    thread_ = std::thread([this] {
        realtime::PeriodicClock clock(period_ns_);
        while (!stop_requested_.load(std::memory_order_relaxed)) {
            clock.wait();
            detect_();
        }
    });
}

void CollisionLoop::stop() {
    if (!thread_.joinable()) return;
    stop_requested_.store(true);
    thread_.join();
}

}  // namespace palpate::haptics
