// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "formats/records/tick_result.hpp"

namespace palpate::session {

/// One fault, from its first to its last tick.
struct FaultEvent {
    Fault fault = no_fault;
    std::int32_t tool = -1;  ///< whose device; -1: all, for a fault of the servo, the window or the asset
    double from = 0;         ///< s since the loop started
    double until = 0;        ///< s, of the last tick that had it
};

/// Tells of each fault once, from the ticks' results: at its first tick. One that comes again before the
/// force is back to the whole is the same one. The end of the run is no fault.
class FaultLog {
  public:
    /// `tell` gets each event when it begins; may be empty.
    explicit FaultLog(std::function<void(const FaultEvent&)> tell = {}) : tell_(std::move(tell)) {}

    /// Takes the results of all tools, tick by tick.
    void add(const TickResult& result);

    const std::vector<FaultEvent>& events() const { return events_; }

  private:
    std::function<void(const FaultEvent&)> tell_;
    std::vector<FaultEvent> events_;
};

/// "12.345 s: the device no longer answers (device_lost); check power and cable"
std::string fault_sentence(const FaultEvent& event);

}  // namespace palpate::session
