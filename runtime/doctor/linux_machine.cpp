// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <langinfo.h>
#include <locale.h>
#include <pwd.h>
#include <sched.h>
#include <string_view>
#include <sys/mman.h>
#include <sys/resource.h>
#include <thread>
#include <time.h>
#include <unistd.h>

#include "runtime/doctor/machine.hpp"

namespace palpate::doctor {
namespace {

using namespace realtime;

std::map<std::string, std::string> environment() {
    std::map<std::string, std::string> result;
    for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
        const std::string_view text(*entry);
        const std::size_t equals = text.find('=');
        if (equals != std::string_view::npos) result.emplace(text.substr(0, equals), text.substr(equals + 1));
    }
    return result;
}

std::uint64_t limit_of(int resource) {
    rlimit limit{};
    if (getrlimit(static_cast<__rlimit_resource_t>(resource), &limit) != 0) return 0;
    return limit.rlim_cur == RLIM_INFINITY ? Machine::unlimited : limit.rlim_cur;
}

SetupResult try_fifo() {
    SetupResult result;
    std::thread([&] { result = request_fifo_priority(Machine::asked_priority); }).join();
    return result;
}

SetupResult try_locking() {
    SetupResult result = lock_memory();
    munlockall();
    return result;
}

// A locale that is not installed leaves programs with "C".
char decimal_point() {
    const locale_t locale = newlocale(LC_NUMERIC_MASK, "", static_cast<locale_t>(nullptr));
    if (locale == static_cast<locale_t>(nullptr)) return '.';
    const char point = *nl_langinfo_l(RADIXCHAR, locale);
    freelocale(locale);
    return point;
}

unsigned usable_cores() {
    cpu_set_t cores;
    if (sched_getaffinity(0, sizeof(cores), &cores) != 0) return std::thread::hardware_concurrency();
    return static_cast<unsigned>(CPU_COUNT(&cores));
}

}  // namespace

Machine this_machine() {
    Machine machine;
    machine.environment = environment();
    machine.superuser = geteuid() == 0;
    const std::string sudo_user = machine.superuser ? variable(machine, "SUDO_USER") : "";
    // NOLINTNEXTLINE(concurrency-mt-unsafe): before the doctor starts a thread
    const passwd* account = sudo_user.empty() ? getpwuid(geteuid()) : getpwnam(sudo_user.c_str());
    if (account != nullptr) {
        machine.user = account->pw_name;
        machine.home = account->pw_dir;
    }
    // NOLINTNEXTLINE(concurrency-mt-unsafe): likewise
    if (const passwd* root = getpwuid(0)) machine.root_home = root->pw_dir;
    if (const std::string home = variable(machine, "HOME"); sudo_user.empty() && !home.empty())
        machine.home = home;
    char host[256] = "";
    if (gethostname(host, sizeof(host) - 1) == 0) machine.host = host;
    machine.cores = usable_cores();
    machine.fifo = try_fifo();
    machine.fifo_limit = limit_of(RLIMIT_RTPRIO);
    machine.locked_memory = try_locking();
    machine.locked_bytes_limit = limit_of(RLIMIT_MEMLOCK);
    timespec resolution{};
    if (clock_getres(CLOCK_MONOTONIC, &resolution) == 0)
        machine.clock_resolution_ns =
            1e9 * static_cast<double>(resolution.tv_sec) + static_cast<double>(resolution.tv_nsec);
    machine.decimal_point = decimal_point();
    return machine;
}

}  // namespace palpate::doctor
