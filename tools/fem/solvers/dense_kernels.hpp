// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <functional>

namespace palpate::fem {

/// Starts the program again with OpenBLAS's kernels for this processor, if OpenBLAS did not find them itself.
/// OpenBLAS up to 0.3.24 takes an Intel processor that is newer than itself for a Prescott of 2004 (its issue
/// 4267) and then computes at a fifth of the speed; which kernels it uses is settled before main() by the
/// environment variable OPENBLAS_CORETYPE, which is left alone where it is set. Call it first in main().
void restart_with_fitting_kernels(char** argv);

/// Limits the threads of the dense kernels.
void set_linear_algebra_threads(int threads);
int linear_algebra_threads();

/// Measures multiplications and additions per second of the dense kernels on one thread, in about 20 ms.
double dense_flops_per_second();

/// Calls job(0) ... job(count - 1) from `threads` threads, each index once, lower ones first; meanwhile dense
/// kernels run in the thread that calls them. The first exception stops the rest and is thrown again.
void for_each_index(std::size_t count, int threads, const std::function<void(std::size_t)>& job);

}  // namespace palpate::fem
