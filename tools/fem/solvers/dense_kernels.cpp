// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/solvers/dense_kernels.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <cblas.h>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <string_view>
#include <thread>
#include <unistd.h>
#include <vector>

namespace palpate::fem {

void restart_with_fitting_kernels(char** argv) {
#if defined(__x86_64__)
    constexpr auto variable = "OPENBLAS_CORETYPE";
    if (getenv(variable) != nullptr || std::string_view(openblas_get_corename()) != "Prescott") return;
    const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
    const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    if (!avx2) return;
    // NOLINTNEXTLINE(concurrency-mt-unsafe): before there is a second thread
    setenv(variable, avx512 ? "SkylakeX" : "Haswell", 1);
    execv("/proc/self/exe", argv);  // returns only if that failed: then it is slow, but right
#else
    static_cast<void>(argv);
#endif
}

int linear_algebra_threads() {
    return openblas_get_num_threads();
}

double dense_flops_per_second() {
    constexpr blasint size = 768;
    const Eigen::MatrixXd a = Eigen::MatrixXd::Constant(size, size, 0.5);
    Eigen::MatrixXd product(size, size);
    double best = 0;
    for_each_index(3, 1, [&](std::size_t) {
        const auto start = std::chrono::steady_clock::now();
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, size, size, size, 1.0, a.data(), size,
                    a.data(), size, 0.0, product.data(), size);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        best = std::max(best, 2.0 * size * size * size / seconds.count());
    });
    return best;
}

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

}  // namespace palpate::fem
