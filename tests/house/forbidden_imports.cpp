// SPDX-License-Identifier: Apache-2.0
// What no object of the tick may import, for the test that tick_imports.py can fail.
#include <cstdio>
#include <mutex>
#include <stdexcept>
#include <vector>

namespace palpate {

void allocate(std::vector<int>& values) {
    values.push_back(1);
}

void lock(std::mutex& mutex) {
    mutex.lock();
}

void write(double force) {
    std::printf("%g\n", force);
}

void refuse(double force) {
    if (force > 3) throw std::runtime_error("too much");
}

}  // namespace palpate
