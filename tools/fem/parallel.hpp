// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <functional>

namespace palpate {

/// Calls job(0) ... job(count - 1) from `threads` threads, each index once, lower ones first; meanwhile dense
/// kernels run in the thread that calls them. The first exception stops the rest and is thrown again.
void for_each_index(std::size_t count, int threads, const std::function<void(std::size_t)>& job);

/// Limits the threads of the dense kernels.
void set_linear_algebra_threads(int threads);

}  // namespace palpate
