// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <utility>

#include "runtime/haptics/methods/contact_method.hpp"

namespace palpate::haptics {

/// A thread beside the ticks that calls `detect` once a period; one that `detect` overruns is skipped.
class CollisionLoop {
  public:
    /// Of what answers positions: 30 times a second is the published loop's fixed rate (§4.2 of the paper
    /// named in published_contact.hpp).
    static constexpr std::int64_t published_period_ns = 1'000'000'000 / 30;
    /// Of what answers forces: the older an answer, the less a hand that moves can trust it.
    static constexpr std::int64_t force_period_ns = 5'000'000;

    static constexpr std::int64_t period_of(Detects detects) noexcept {
        return detects == Detects::forces ? force_period_ns : published_period_ns;
    }

    /// `detect` must not throw; what it refers to must outlive the loop.
    CollisionLoop(std::function<void()> detect, std::int64_t period_ns)
        : detect_(std::move(detect)), period_ns_(period_ns) {}
    CollisionLoop(const CollisionLoop&) = delete;
    CollisionLoop& operator=(const CollisionLoop&) = delete;
    ~CollisionLoop() { stop(); }

    /// Starts the thread, once only; the first call of `detect` comes one period later.
    void start();
    /// Asks the thread to end and waits for it: at most one period and one call.
    void stop();

  private:
    std::function<void()> detect_;
    std::int64_t period_ns_;
    std::atomic<bool> stop_requested_{false};
    std::thread thread_;
};

}  // namespace palpate::haptics
