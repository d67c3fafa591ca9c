// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace palpate::realtime {

/// Counts durations in log-linear buckets: exact below 64 ns, then 32 buckets per octave (3 % wide) up to
/// 2^40 ns. record() is constant-time and never allocates. One thread at a time.
class Histogram {
  public:
    void record(std::uint64_t nanoseconds) noexcept;
    /// The smallest recorded-bucket bound that at least `fraction` (0 ... 1) of the values do not exceed, ns;
    /// at most 3 % above the true quantile; 0 if nothing was recorded.
    std::uint64_t percentile(double fraction) const noexcept;
    std::uint64_t count() const noexcept { return count_; }
    std::uint64_t max() const noexcept { return max_; }  ///< exact, ns

  private:
    static constexpr unsigned linear_bits = 6;
    static constexpr unsigned octaves = 40 - linear_bits;
    static constexpr std::size_t half = std::size_t{1} << (linear_bits - 1);
    static std::size_t bucket_of(std::uint64_t value) noexcept;
    static std::uint64_t upper_bound_of(std::size_t bucket) noexcept;

    std::array<std::uint64_t, 2 * half + octaves * half> counts_{};
    std::uint64_t count_ = 0;
    std::uint64_t max_ = 0;
};

}  // namespace palpate::realtime
