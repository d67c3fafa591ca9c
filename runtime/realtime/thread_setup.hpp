// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace palpate::realtime {

/// What became of a request to the operating system; a refused one is not fatal, only slower.
struct SetupResult {
    bool ok = false;
    std::string message;  ///< what was done, or why not and how to permit it
};

/// Gives the calling thread SCHED_FIFO at `priority` (1 ... 99).
SetupResult request_fifo_priority(int priority);

/// Locks all present and future pages of the process in memory, so that no tick waits for the disk.
SetupResult lock_memory();

}  // namespace palpate::realtime
