// SPDX-License-Identifier: Apache-2.0
#include "runtime/doctor/checks/realtime_checks.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fmt/format.h>
#include <set>

namespace palpate::doctor {
namespace {

constexpr const char* realtime_group = "real time";
constexpr const char* limits_file = "/etc/security/limits.d/99-palpate.conf";

bool in_container(const Machine& machine) {
    std::error_code error;
    return std::filesystem::exists(in_root(machine, "/.dockerenv"), error) ||
           std::filesystem::exists(in_root(machine, "/run/.containerenv"), error) ||
           !variable(machine, "container").empty();
}

// What follows "key : " or "key=" in a file of such lines; empty if there is none.
std::string value_in(const std::string& text, const std::string& key) {
    for (std::size_t start = 0; start < text.size();) {
        const std::size_t end = std::min(text.find('\n', start), text.size());
        const std::string line = text.substr(start, end - start);
        if (line.starts_with(key)) {
            const std::size_t value = line.find_first_not_of(" \t:=\"", key.size());
            if (value == std::string::npos) return "";
            return line.substr(value, line.find_last_not_of(" \"") + 1 - value);
        }
        start = end + 1;
    }
    return "";
}

bool hypervisor(const Machine& machine) {
    const std::string flags = value_in(text_of(machine, "/proc/cpuinfo").value_or(""), "flags");
    return (" " + flags + " ").find(" hypervisor ") != std::string::npos;
}

// How this user comes by real-time priority and locked memory.
std::string permit_fix(const Machine& machine) {
    if (in_container(machine))
        return "# start the container with these options:\n"
               "docker run --cap-add SYS_NICE --ulimit rtprio=99 --ulimit memlock=-1:-1 ...";
    if (text_of(machine, limits_file).value_or("").find(machine.user + " ") != std::string::npos)
        return fmt::format("# {} names you, but this session is older: log out and in again", limits_file);
    return fmt::format(
        "printf '%s\\n' '{0} - rtprio 99' '{0} - memlock unlimited' | sudo tee {1}\n"
        "# then log out and in again",
        machine.user, limits_file);
}

Finding system(const Machine& machine) {
    const std::string name = value_in(text_of(machine, "/etc/os-release").value_or(""), "PRETTY_NAME");
    const std::string cpu = value_in(text_of(machine, "/proc/cpuinfo").value_or(""), "model name");
    const bool patched = text_of(machine, "/sys/kernel/realtime").value_or("") == "1";
    return {"system", realtime_group, Level::ok,
            fmt::format("{}, Linux {}{}, {}", name.empty() ? "unnamed system" : name,
                        text_of(machine, "/proc/sys/kernel/osrelease").value_or("of unknown release"),
                        patched ? " (PREEMPT_RT)" : "", cpu.empty() ? "unnamed CPU" : cpu),
            ""};
}

Finding fifo(const Machine& machine, Purpose purpose) {
    Finding finding{"fifo", realtime_group, Level::ok, "SCHED_FIFO is permitted", ""};
    if (machine.fifo.ok) return finding;
    finding.level = lack_of(purpose);
    finding.found = fmt::format("SCHED_FIFO is refused: priority {} asked, limit {} (RLIMIT_RTPRIO)",
                                Machine::asked_priority, machine.fifo_limit);
    // sched(7): with real-time group scheduling a control group without a share may have no such thread.
    finding.fix =
        machine.fifo_limit >= Machine::asked_priority
            ? "# the limit allows it and the control group of this session does not; this lifts a brake of\n"
              "# the whole system: a real-time thread that never sleeps may then hold a core for ever\n"
              "sudo sysctl -w kernel.sched_rt_runtime_us=-1"
            : permit_fix(machine);
    return finding;
}

Finding memory(const Machine& machine) {
    Finding finding{"memory_lock", realtime_group, Level::ok, "memory can be locked", ""};
    constexpr std::uint64_t ample = std::uint64_t{4} << 30;  // bytes; the largest cases take some hundred MB
    if (machine.locked_memory.ok && (machine.superuser || machine.locked_bytes_limit >= ample))
        return finding;
    finding.level = Level::warning;
    finding.found =
        fmt::format("no more than {} MiB can be locked (RLIMIT_MEMLOCK), and a case may take more",
                    machine.locked_bytes_limit >> 20);
    finding.fix = permit_fix(machine);
    return finding;
}

Finding timer(const Machine& machine) {
    constexpr double enough_ns = 1000;
    const bool fine = machine.clock_resolution_ns > 0 && machine.clock_resolution_ns <= enough_ns;
    return {"timer", realtime_group, fine ? Level::ok : Level::warning,
            fmt::format("timers resolve {} ns", machine.clock_resolution_ns),
            fine ? ""
                 : "# the kernel runs without high-resolution timers; remove 'highres=off' and 'nohz=off'\n"
                   "sudo sed -i 's/ *\\(highres\\|nohz\\)=off//g' /etc/default/grub && sudo update-grub && "
                   "sudo reboot"};
}

Finding clock_source(const Machine& machine) {
    const std::filesystem::path folder = "/sys/devices/system/clocksource/clocksource0";
    const auto current = text_of(machine, folder / "current_clocksource");
    if (!current) return {"clock_source", realtime_group, Level::ok, "the kernel does not say", ""};
    // Read through a bus, some microseconds a time, or no clock at all.
    constexpr std::array<std::string_view, 4> slow{"hpet", "acpi_pm", "jiffies", "refined-jiffies"};
    Finding finding{"clock_source", realtime_group, Level::ok, *current, ""};
    if (std::ranges::find(slow, *current) == slow.end()) return finding;
    finding.level = Level::warning;
    finding.found += ", which is slow to read";
    const std::string others = text_of(machine, folder / "available_clocksource").value_or("");
    finding.fix = (" " + others + " ").find(" tsc ") != std::string::npos
                      ? fmt::format("echo tsc | sudo tee {}/current_clocksource", folder.string())
                      : "# the kernel holds this CPU's time stamp counter for unstable; see why:\n"
                        "sudo dmesg | grep -i -e clocksource -e tsc";
    return finding;
}

Finding governor(const Machine& machine) {
    std::set<std::string> others;
    std::size_t cores = 0, slow = 0;
    std::error_code error;
    for (const auto& entry :
         std::filesystem::directory_iterator(in_root(machine, "/sys/devices/system/cpu"), error)) {
        const auto place = "/sys/devices/system/cpu" / entry.path().filename() / "cpufreq/scaling_governor";
        const auto name = text_of(machine, place);
        if (!name) continue;
        ++cores;
        if (*name == "performance") continue;
        ++slow;
        others.insert(*name);
    }
    if (cores == 0) return {"governor", realtime_group, Level::ok, "no CPU frequency is set from here", ""};
    if (slow == 0) return {"governor", realtime_group, Level::ok, "performance", ""};
    return {"governor", realtime_group, Level::warning,
            fmt::format("{} on {} of {} cores; a core that slows down wakes late", fmt::join(others, ", "),
                        slow, cores),
            "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor\n"
            "# that lasts until the next start; for good:\n"
            "sudo apt install cpufrequtils && echo GOVERNOR=performance | sudo tee "
            "/etc/default/cpufrequtils"};
}

Finding isolation(const Machine& machine) {
    const std::string cores = text_of(machine, "/sys/devices/system/cpu/isolated").value_or("");
    return {"isolated_cores", realtime_group, Level::ok, cores.empty() ? "none" : cores, ""};
}

Finding real_time_share(const Machine& machine) {
    const auto number = [&](const char* name) {
        const auto text = text_of(machine, std::filesystem::path("/proc/sys/kernel") / name);
        return text ? std::optional(std::strtol(text->c_str(), nullptr, 10)) : std::nullopt;
    };
    const auto runtime = number("sched_rt_runtime_us");
    const long period = number("sched_rt_period_us").value_or(1'000'000);
    Finding finding{"rt_share", realtime_group, Level::ok, "", ""};
    if (!runtime) {
        finding.found = "the kernel does not say";
    } else if (*runtime < 0) {
        finding.found = "real-time threads may run all the time";
    } else {
        finding.found = fmt::format("real-time threads may run {} of {} us", *runtime, period);
        if (2 * *runtime < period) {  // less than half of each period
            finding.level = Level::warning;
            finding.fix =
                "echo kernel.sched_rt_runtime_us=950000 | sudo tee /etc/sysctl.d/99-palpate.conf && "
                "sudo sysctl --system";
        }
    }
    return finding;
}

Finding load(const Machine& machine) {
    const double busy = std::strtod(text_of(machine, "/proc/loadavg").value_or("0").c_str(), nullptr);
    Finding finding{"load", realtime_group, Level::ok,
                    fmt::format("{} cores, {:.1f} of them busy in the last minute", machine.cores, busy), ""};
    if (machine.cores < 2) {
        finding.level = Level::warning;
        finding.found += "; contact and picture need one each";
        finding.fix = "# give this machine, container or process two cores or more";
    } else if (busy > machine.cores) {
        finding.level = Level::warning;
        finding.fix = "# end what else is running, the first in this list:\ntop -b -n 1 -o %CPU | head -n 12";
    }
    return finding;
}

Finding surroundings(const Machine& machine) {
    const bool container = in_container(machine), virtual_machine = hypervisor(machine);
    return {"virtualisation", realtime_group, Level::ok,
            container && virtual_machine ? "a container in a virtual machine"
            : container                  ? "a container"
            : virtual_machine            ? "a virtual machine"
                                         : "none seen",
            ""};
}

}  // namespace

Findings realtime_findings(const Machine& machine, Purpose purpose) {
    return {system(machine),          surroundings(machine), fifo(machine, purpose), memory(machine),
            timer(machine),           clock_source(machine), governor(machine),      isolation(machine),
            real_time_share(machine), load(machine)};
}

}  // namespace palpate::doctor
