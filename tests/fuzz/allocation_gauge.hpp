// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

namespace palpate {

/// Size in bytes of the largest block that operator new was asked for since the last reset, in any thread.
std::size_t largest_allocation();
void reset_largest_allocation();

}  // namespace palpate
