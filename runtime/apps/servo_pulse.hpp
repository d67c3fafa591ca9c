// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <spdlog/spdlog.h>

#include "formats/model/errors.hpp"
#include "tools/cli/outputs/staged_file.hpp"

namespace palpate::apps {

/// Notices a servo that has stopped.
class ServoPulse {
  public:
    /// Takes the number of the latest tick. Throws SystemFailure if it has not changed for 5 s, and says so
    /// first, for a driver that hangs may not let its device be closed: the process ends 3 s later anyway.
    void see(std::int64_t tick) {
        constexpr std::chrono::seconds patience{5};
        constexpr int closing_s = 3;
        const auto now = std::chrono::steady_clock::now();
        if (tick != tick_) since_ = now;
        tick_ = tick;
        if (now - since_ < patience) return;
        const SystemFailure failure({"the servo", "has not ticked for 5 s", "1000 ticks a second",
                                     "check the device's cable, then 'palpate doctor'"});
        spdlog::error("{}", failure.what());
        cli::end_within(closing_s);
        throw failure;
    }

  private:
    std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
    std::int64_t tick_ = -1;
};

}  // namespace palpate::apps
