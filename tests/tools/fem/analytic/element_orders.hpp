// SPDX-License-Identifier: GPL-3.0-or-later
// Suites that run once for linear and once for quadratic tetrahedra: fem.Both/<Suite>.<case>/linear.
#pragma once
#include <gtest/gtest.h>

#include "formats/model/body.hpp"

namespace palpate::test {

/// Base of such a suite; GetParam() is the element order.
using PerElementOrder = ::testing::TestWithParam<ElementOrder>;

inline auto element_orders() {
    return ::testing::Values(ElementOrder::linear, ElementOrder::quadratic);
}

inline std::string order_name(const ::testing::TestParamInfo<ElementOrder>& info) {
    return info.param == ElementOrder::linear ? "linear" : "quadratic";
}

}  // namespace palpate::test
