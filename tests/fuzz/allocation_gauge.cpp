// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/allocation_gauge.hpp"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <malloc.h>
#include <new>
#ifdef PALPATE_SANITIZED
#include <sanitizer/allocator_interface.h>
#endif

namespace {

std::atomic<std::size_t> largest{0};
std::atomic<std::ptrdiff_t> held{0}, base{0}, peak{0};

template <typename T>
void raise(std::atomic<T>& most, T value) {
    T before = most.load();
    while (value > before && !most.compare_exchange_weak(before, value)) {
    }
}

void note(std::size_t size) {
    raise(largest, size);
    raise(peak, held += static_cast<std::ptrdiff_t>(size));
}

void note_freed(std::size_t size) {
    held -= static_cast<std::ptrdiff_t>(size);
}

}  // namespace

#ifndef PALPATE_SANITIZED
void* operator new(std::size_t size) {
    void* memory = std::malloc(size);
    if (memory == nullptr) throw std::bad_alloc();
    note(malloc_usable_size(memory));
    return memory;
}

void operator delete(void* memory) noexcept {
    note_freed(malloc_usable_size(memory));
    std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
    operator delete(memory);
}
#else
// A sanitizer calls these for every allocation (sanitizer/allocator_interface.h).
extern "C" void __sanitizer_malloc_hook(const volatile void*, std::size_t size) {
    note(size);
}

extern "C" void __sanitizer_free_hook(const volatile void* memory) {
    if (memory != nullptr) note_freed(__sanitizer_get_allocated_size(memory));
}
#endif

namespace palpate {

std::size_t largest_allocation() {
    return largest.load();
}

void reset_largest_allocation() {
    largest = 0;
}

std::size_t peak_allocation() {
    return static_cast<std::size_t>(peak - base);
}

void reset_peak_allocation() {
    base = held.load();
    peak = held.load();
}

}  // namespace palpate
