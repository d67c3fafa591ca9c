// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "runtime/realtime/thread_setup.hpp"

namespace palpate::doctor {

/// What the checks know of a machine beside its files.
struct Machine {
    static constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();
    static constexpr int asked_priority = 80;  ///< of SCHED_FIFO, as PeriodicServo asks

    std::filesystem::path root = "/";  ///< below which /proc, /sys, /etc and the libraries lie
    std::string user;                  ///< who runs this, or who asked sudo to
    std::filesystem::path home;        ///< of that user
    std::filesystem::path root_home;   ///< of root
    std::string host;
    bool superuser = false;
    std::map<std::string, std::string> environment;
    unsigned cores = 1;                    ///< that this process may use
    realtime::SetupResult fifo;            ///< SCHED_FIFO, tried on a thread
    std::uint64_t fifo_limit = 0;          ///< highest that an unprivileged process may ask
    realtime::SetupResult locked_memory;   ///< all pages of this process, tried and let go
    std::uint64_t locked_bytes_limit = 0;  ///< that an unprivileged process may lock
    double clock_resolution_ns = 0;        ///< of the monotonic clock's timers
    char decimal_point = '.';              ///< of the user's locale
};

/// The machine and the user this process runs on and for. Tries SCHED_FIFO on a thread of its own and
/// locking memory; leaves neither behind. Reads what Linux offers.
Machine this_machine();

/// Where `path` (absolute) lies below the machine's root.
std::filesystem::path in_root(const Machine& machine, const std::filesystem::path& path);
/// The first MiB of a file below the root without blanks at its end; nothing if it cannot be read.
std::optional<std::string> text_of(const Machine& machine, const std::filesystem::path& path);
/// An environment variable; empty if it is not set.
std::string variable(const Machine& machine, const std::string& name);

}  // namespace palpate::doctor
