// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/doctor/finding.hpp"
#include "runtime/doctor/machine.hpp"

namespace palpate::doctor {

/// Checks what a loop at 1 kHz needs of the operating system: SCHED_FIFO, locked memory, timers, the clock's
/// source, the CPU governor, the share of real-time threads, load; and tells what the machine is.
/// Sources: sched(7), mlock(2), limits.conf(5), and the kernel's documentation of cpufreq, isolcpus and
/// clocksource.
Findings realtime_findings(const Machine& machine, Purpose purpose);

}  // namespace palpate::doctor
