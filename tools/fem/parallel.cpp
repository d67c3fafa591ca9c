// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <cblas.h>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace palpate {

void set_linear_algebra_threads(int threads) {
    openblas_set_num_threads(threads);
}

void for_each_index(std::size_t count, int threads, const std::function<void(std::size_t)>& job) {
    const int dense_threads = openblas_get_num_threads();
    set_linear_algebra_threads(1);
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failing;
    const auto work = [&] {
        for (std::size_t index = next++; index < count; index = next++) try {
                job(index);
            } catch (...) {
                const std::lock_guard lock(failing);
                if (!failure) failure = std::current_exception();
                next = count;
            }
    };
    {
        std::vector<std::jthread> others;
        for (int t = 1; t < std::min(threads, static_cast<int>(count)); ++t) others.emplace_back(work);
        work();
    }
    set_linear_algebra_threads(dense_threads);
    if (failure) std::rethrow_exception(failure);
}

}  // namespace palpate
