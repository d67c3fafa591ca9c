// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>

namespace palpate {

using Json = nlohmann::ordered_json;

/// Seconds on a clock that nobody sets.
double now_seconds();

/// What one piece of work cost.
struct Cost {
    double seconds = 0;      ///< wall clock
    double cpu_seconds = 0;  ///< of all threads, kernel included; waiting OpenBLAS threads spin, and count
    std::int64_t peak_bytes = 0;  ///< most resident memory beyond what the process held before
};

/// Runs `work` and measures it. The peak is the process's, so call it first thing in in_child().
Cost cost_of(const std::function<void()>& work);

/// As "seconds", "cpu_seconds" and "peak_bytes".
Json to_json(const Cost& cost);

/// Runs `work` in a forked child and returns what it returns, so that each piece of work starts from the same
/// memory and leaves none behind. Throws SystemFailure with the child's message, or how it died. The calling
/// process must not run threads of its own (OpenBLAS stops its threads before a fork).
Json in_child(const std::function<Json()>& work);

}  // namespace palpate
