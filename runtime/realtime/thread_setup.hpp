// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
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

/// What prefault_stack() makes sure of, bytes: more than a tick needs.
inline constexpr std::size_t prefaulted_stack = std::size_t{256} * 1024;

/// Touches that much of the calling thread's stack, so that where locking memory is refused no tick is the
/// first to use a page of it.
void prefault_stack() noexcept;

}  // namespace palpate::realtime
