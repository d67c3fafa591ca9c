// SPDX-License-Identifier: Apache-2.0
#include "runtime/realtime/process_age.hpp"

#include <fstream>
#include <limits>
#include <string>
#include <time.h>
#include <unistd.h>

namespace palpate::realtime {

double process_age() {
    // proc(5): field 22 of /proc/self/stat is the start in clock ticks since boot. Field 2, the name in
    // brackets, may contain blanks.
    std::ifstream stat("/proc/self/stat");
    stat.ignore(std::numeric_limits<std::streamsize>::max(), ')');
    std::string skipped;
    for (int field = 3; field < 22; ++field) stat >> skipped;
    double start_ticks = 0;
    stat >> start_ticks;
    timespec now{};
    clock_gettime(CLOCK_BOOTTIME, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) -
           start_ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace palpate::realtime
