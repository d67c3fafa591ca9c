// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "formats/records/tick_result.hpp"
#include "runtime/realtime/spsc_ring.hpp"
#include "runtime/realtime/triple_buffer.hpp"

namespace palpate::haptics {

/// Where a loop's results leave its thread: the latest of each tool for the visual side, every one for a
/// logger. Copies the contacts that count and no others, for a tick waits for what it copies.
class TickOutlet {
  public:
    explicit TickOutlet(std::size_t tools, std::size_t ring_capacity = 4096);

    /// Hands over one tick's results, one of each tool; a full ring drops and counts them. Realtime-safe, one
    /// thread.
    void publish(std::span<const TickResult> results) noexcept;

    /// The latest result of one tool, for one reader.
    realtime::TripleBuffer<TickResult>& latest(std::size_t tool) noexcept { return *latest_[tool]; }
    /// The results of all tools, for one consumer.
    realtime::SpscRing<TickResult>& ring() noexcept { return ring_; }
    const realtime::SpscRing<TickResult>& ring() const noexcept { return ring_; }

  private:
    std::vector<std::unique_ptr<realtime::TripleBuffer<TickResult>>> latest_;  // one per tool
    realtime::SpscRing<TickResult> ring_;
};

}  // namespace palpate::haptics
