// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::case_builder {

/// How a child process ended and what it took.
struct ChildResult {
    int exit_code = 0;                   ///< 128 + signal if a signal ended it
    double seconds = 0;                  ///< wall time
    std::int64_t peak_memory_bytes = 0;  ///< largest resident set
};

/// Runs a program to its end with this process's stdin and stderr; its stdout is discarded. SIGINT and
/// SIGTERM that reach this process are passed on, and the child is waited for before this process ends.
/// Throws SystemFailure if the program cannot be started.
ChildResult run_child(const std::filesystem::path& program, const std::vector<std::string>& arguments);

}  // namespace palpate::case_builder
