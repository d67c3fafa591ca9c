// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>

#include "runtime/realtime/histogram.hpp"

namespace palpate::session {

/// p50, p99, p99_9 and max of a histogram of nanoseconds, in units of `unit_ns`.
inline nlohmann::ordered_json percentiles_json(const realtime::Histogram& histogram, double unit_ns) {
    const auto in_unit = [&](std::uint64_t ns) { return static_cast<double>(ns) / unit_ns; };
    return {{"p50", in_unit(histogram.percentile(0.5))},
            {"p99", in_unit(histogram.percentile(0.99))},
            {"p99_9", in_unit(histogram.percentile(0.999))},
            {"max", in_unit(histogram.max())}};
}

}  // namespace palpate::session
