// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/allocation_gauge.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> largest{0};

void note(std::size_t size) {
    std::size_t before = largest.load();
    while (size > before && !largest.compare_exchange_weak(before, size)) {
    }
}

}  // namespace

#ifndef PALPATE_SANITIZED
void* operator new(std::size_t size) {
    note(size);
    if (void* memory = std::malloc(size)) return memory;
    throw std::bad_alloc();
}

void operator delete(void* memory) noexcept {
    std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
#else
// A sanitizer calls this for every allocation (sanitizer/allocator_interface.h).
extern "C" void __sanitizer_malloc_hook(const volatile void*, std::size_t size) {
    note(size);
}
#endif

namespace palpate {

std::size_t largest_allocation() {
    return largest.load();
}

void reset_largest_allocation() {
    largest = 0;
}

}  // namespace palpate
