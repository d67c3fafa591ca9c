// SPDX-License-Identifier: Apache-2.0
#include "runtime/realtime/histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace palpate::realtime {

std::size_t Histogram::bucket_of(std::uint64_t value) noexcept {
    value = std::min(value, (std::uint64_t{1} << (linear_bits + octaves)) - 1);
    if (value < 2 * half) return static_cast<std::size_t>(value);
    // In octave o >= 1 the value's top linear_bits bits lie in [half, 2 half).
    const auto octave = static_cast<unsigned>(std::bit_width(value)) - linear_bits;
    return half * octave + static_cast<std::size_t>(value >> octave);
}

std::uint64_t Histogram::upper_bound_of(std::size_t bucket) noexcept {
    if (bucket < 2 * half) return bucket;
    const std::size_t octave = bucket / half - 1;
    const std::uint64_t top = bucket - half * octave;
    return ((top + 1) << octave) - 1;
}

void Histogram::record(std::uint64_t nanoseconds) noexcept {
    ++counts_[bucket_of(nanoseconds)];
    ++count_;
    max_ = std::max(max_, nanoseconds);
}

std::uint64_t Histogram::percentile(double fraction) const noexcept {
    const auto wanted = static_cast<std::uint64_t>(std::ceil(fraction * static_cast<double>(count_)));
    std::uint64_t seen = 0;
    for (std::size_t bucket = 0; bucket < counts_.size(); ++bucket) {
        seen += counts_[bucket];
        if (seen > 0 && seen >= wanted) return std::min(upper_bound_of(bucket), max_);
    }
    return max_;
}

}  // namespace palpate::realtime
