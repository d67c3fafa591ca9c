// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/allocation_trap.hpp"

#include <cstddef>

namespace {

thread_local bool armed = false;
thread_local std::size_t allocations = 0;

}  // namespace

#ifndef PALPATE_SANITIZED
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
    if (armed) ++allocations;
    return __libc_malloc(size);
}
#else
// A sanitizer calls this for every allocation (sanitizer/allocator_interface.h).
extern "C" void __sanitizer_malloc_hook(const volatile void*, std::size_t) {
    if (armed) ++allocations;
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
