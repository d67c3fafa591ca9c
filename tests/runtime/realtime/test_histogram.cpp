// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "runtime/realtime/histogram.hpp"

namespace palpate {
namespace {

using namespace realtime;

TEST(Histogram, is_exact_for_small_values) {
    Histogram histogram;
    for (std::uint64_t i = 1; i <= 60; ++i) histogram.record(i);
    EXPECT_EQ(histogram.percentile(0.5), 30U);
    EXPECT_EQ(histogram.percentile(1), 60U);
    EXPECT_EQ(histogram.percentile(0), 1U);
    EXPECT_EQ(histogram.count(), 60U);
    EXPECT_EQ(histogram.max(), 60U);
}

TEST(Histogram, quantiles_are_within_a_bucket_of_the_sorted_values) {
    Histogram histogram;
    std::mt19937 generator(1);
    std::lognormal_distribution<double> nanoseconds(8, 2);
    std::vector<std::uint64_t> values;
    for (int i = 0; i < 20000; ++i) {
        values.push_back(static_cast<std::uint64_t>(nanoseconds(generator)));
        histogram.record(values.back());
    }
    std::ranges::sort(values);
    for (const double fraction : {0.01, 0.5, 0.9, 0.99, 0.999, 1.0}) {
        const auto rank = static_cast<std::size_t>(std::ceil(fraction * 20000)) - 1;
        const auto exact = static_cast<double>(values[rank]);
        const auto found = static_cast<double>(histogram.percentile(fraction));
        EXPECT_GE(found, exact);
        EXPECT_LE(found, exact * (1 + 1.0 / 32) + 1) << fraction;
    }
    EXPECT_EQ(histogram.max(), values.back());
}

TEST(Histogram, holds_what_is_longer_than_its_range) {
    Histogram histogram;
    histogram.record(std::uint64_t{1} << 50);
    EXPECT_EQ(histogram.max(), std::uint64_t{1} << 50);
    EXPECT_EQ(histogram.count(), 1U);
    EXPECT_GT(histogram.percentile(0.5), std::uint64_t{1} << 39);
}

TEST(Histogram, is_zero_when_empty) {
    EXPECT_EQ(Histogram().percentile(0.5), 0U);
}

}  // namespace
}  // namespace palpate
