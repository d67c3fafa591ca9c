// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string_view>

namespace palpate {

/// Called by long work with what happens now and the fraction of the whole that is done (0 ... 1).
using ProgressCallback = std::function<void(std::string_view what, double fraction)>;

}  // namespace palpate
