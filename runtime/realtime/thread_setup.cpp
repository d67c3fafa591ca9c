// SPDX-License-Identifier: Apache-2.0
#include "runtime/realtime/thread_setup.hpp"

#include <cerrno>
#include <cstddef>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <system_error>

namespace palpate::realtime {
namespace {

SetupResult outcome(int error, const std::string& done, const std::string& remedy) {
    if (error == 0) return {true, done};
    return {false, done + " was refused: " + std::generic_category().message(error) + "; " + remedy};
}

}  // namespace

SetupResult request_fifo_priority(int priority) {
    sched_param parameter{};
    parameter.sched_priority = priority;
    return outcome(pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter),
                   "SCHED_FIFO priority " + std::to_string(priority),
                   "allow it with 'rtprio' in /etc/security/limits.conf");
}

SetupResult lock_memory() {
    return outcome(mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno, "locking memory",
                   "allow it with 'memlock' in /etc/security/limits.conf");
}

[[gnu::noinline]] void prefault_stack() noexcept {
    constexpr std::size_t page = 4096;  // or a divisor of it
    volatile char stack[prefaulted_stack];
    for (std::size_t at = 0; at < prefaulted_stack; at += page) stack[at] = 0;
    asm volatile("" : : "r"(stack) : "memory");  // or Clang keeps the touched bytes alone
}

}  // namespace palpate::realtime
