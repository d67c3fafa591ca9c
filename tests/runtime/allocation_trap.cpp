// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/allocation_trap.hpp"

#include <cstdlib>
#include <new>

namespace {

thread_local bool armed = false;
thread_local std::size_t allocations = 0;

}  // namespace

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
    if (armed) ++allocations;
    return __libc_malloc(size);
}
#else
void* operator new(std::size_t size) {
    if (armed) ++allocations;
    if (void* memory = std::malloc(size)) return memory;
    throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    if (armed) ++allocations;
    return std::malloc(size);
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
#endif

namespace palpate {

AllocationTrap::AllocationTrap() {
    allocations = 0;
    armed = true;
}

AllocationTrap::~AllocationTrap() {
    armed = false;
}

std::size_t AllocationTrap::count() const {
    return allocations;
}

}  // namespace palpate
