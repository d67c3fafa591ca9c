// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

namespace palpate {

/// Size in bytes of the largest block that was asked for since the last reset, in any thread.
std::size_t largest_allocation();
void reset_largest_allocation();

/// The most bytes that were held at once since the last reset, beyond those held at that time.
std::size_t peak_allocation();
void reset_peak_allocation();

}  // namespace palpate
