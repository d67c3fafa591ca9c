// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <utility>

namespace palpate::haptics {

/// The published collision loop: a thread that calls `detect` 30 times a second, with 30 as its fixed rate
/// (§4.2 of the paper named in published_contact.hpp). A period that `detect` overruns is skipped.
class CollisionLoop {
  public:
    static constexpr std::int64_t rate_hz = 30;
    static constexpr std::int64_t period_ns = 1'000'000'000 / rate_hz;

    /// `detect` must not throw; what it refers to must outlive the loop.
    explicit CollisionLoop(std::function<void()> detect) : detect_(std::move(detect)) {}
    CollisionLoop(const CollisionLoop&) = delete;
    CollisionLoop& operator=(const CollisionLoop&) = delete;
    ~CollisionLoop() { stop(); }

    /// Starts the thread, once only; the first call of `detect` comes one period later.
    void start();
    /// Asks the thread to end and waits for it: at most one period and one call.
    void stop();

  private:
    std::function<void()> detect_;
    std::atomic<bool> stop_requested_{false};
    std::thread thread_;
};

}  // namespace palpate::haptics
