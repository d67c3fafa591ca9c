// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/doctor/checks/realtime_checks.hpp"
#include "tests/runtime/doctor/made_up_machine.hpp"

namespace palpate {
namespace {

using namespace doctor;
using sample::find;
using ::testing::HasSubstr;

const std::string cpus = "/sys/devices/system/cpu/";
const std::string clock_folder = "/sys/devices/system/clocksource/clocksource0/";

struct RealtimeChecks : testing::Test {
    sample::MadeUpMachine machine;

    Finding check(const std::string& id, Purpose purpose = Purpose::device) const {
        return find(realtime_findings(machine, purpose), id);
    }
};

TEST_F(RealtimeChecks, a_machine_that_lacks_nothing_has_nothing_but_ok) {
    machine.write(cpus + "cpu0/cpufreq/scaling_governor", "performance\n");
    machine.write(clock_folder + "current_clocksource", "tsc\n");
    machine.write("/proc/sys/kernel/sched_rt_runtime_us", "950000\n");
    machine.write("/proc/loadavg", "0.50 0.40 0.30 1/90 1\n");
    const Findings findings = realtime_findings(machine, Purpose::device);
    EXPECT_EQ(count(findings, Level::ok), findings.size());
}

TEST_F(RealtimeChecks, a_machine_without_any_file_is_examined_too) {
    const Findings findings = realtime_findings(machine, Purpose::device);
    EXPECT_EQ(count(findings, Level::ok), findings.size());
}

TEST_F(RealtimeChecks, a_refused_priority_is_a_problem_for_a_device_and_a_warning_for_a_simulation) {
    machine.fifo.ok = false;
    machine.fifo_limit = 0;
    const Finding finding = check("fifo");
    EXPECT_EQ(finding.level, Level::problem);
    EXPECT_EQ(check("fifo", Purpose::simulation).level, Level::warning);
    EXPECT_EQ(finding.fix,
              "printf '%s\\n' 'ada - rtprio 99' 'ada - memlock unlimited' | sudo tee "
              "/etc/security/limits.d/99-palpate.conf\n# then log out and in again");
}

TEST_F(RealtimeChecks, a_priority_refused_within_its_limit_is_the_control_groups_doing) {
    machine.fifo.ok = false;
    EXPECT_THAT(check("fifo").fix, HasSubstr("sysctl -w kernel.sched_rt_runtime_us=-1"));
}

TEST_F(RealtimeChecks, a_permission_given_after_the_login_asks_for_another_login) {
    machine.fifo.ok = false;
    machine.fifo_limit = 0;
    machine.write("/etc/security/limits.d/99-palpate.conf", "ada - rtprio 99\nada - memlock unlimited\n");
    EXPECT_THAT(check("fifo").fix, HasSubstr("this session is older: log out and in again"));
}

TEST_F(RealtimeChecks, a_container_is_permitted_from_outside) {
    machine.fifo.ok = false;
    machine.fifo_limit = 0;
    machine.write("/.dockerenv", "");
    EXPECT_THAT(check("fifo").fix, HasSubstr("--cap-add SYS_NICE"));
    EXPECT_EQ(check("virtualisation").found, "a container");
}

TEST_F(RealtimeChecks, a_small_limit_of_locked_memory_is_told) {
    machine.locked_bytes_limit = 8U << 20;
    const Finding finding = check("memory_lock");
    EXPECT_EQ(finding.level, Level::warning);
    EXPECT_THAT(finding.found, HasSubstr("no more than 8 MiB"));
    EXPECT_THAT(finding.fix, HasSubstr("ada - memlock unlimited"));
}

TEST_F(RealtimeChecks, cores_that_save_power_are_counted) {
    machine.write(cpus + "cpu0/cpufreq/scaling_governor", "performance\n");
    machine.write(cpus + "cpu1/cpufreq/scaling_governor", "powersave\n");
    machine.write(cpus + "cpu2/cpufreq/scaling_governor", "schedutil\n");
    machine.write(cpus + "isolated", "2-3\n");
    EXPECT_THAT(check("governor").found, HasSubstr("powersave, schedutil on 2 of 3 cores"));
    EXPECT_THAT(check("governor").fix, HasSubstr("echo performance"));
    EXPECT_EQ(check("isolated_cores").found, "2-3");
}

TEST_F(RealtimeChecks, a_slow_clock_is_changed_where_a_faster_one_is_offered) {
    machine.write(clock_folder + "current_clocksource", "hpet\n");
    machine.write(clock_folder + "available_clocksource", "tsc hpet acpi_pm \n");
    EXPECT_EQ(check("clock_source").level, Level::warning);
    EXPECT_THAT(check("clock_source").fix, HasSubstr("echo tsc | sudo tee"));
    machine.write(clock_folder + "available_clocksource", "hpet acpi_pm\n");
    EXPECT_THAT(check("clock_source").fix, HasSubstr("dmesg"));
}

TEST_F(RealtimeChecks, timers_of_a_kernel_tick_are_too_coarse) {
    machine.clock_resolution_ns = 4e6;
    EXPECT_EQ(check("timer").level, Level::warning);
}

TEST_F(RealtimeChecks, a_small_share_for_real_time_threads_is_told_and_no_limit_is_not) {
    machine.write("/proc/sys/kernel/sched_rt_period_us", "1000000\n");
    machine.write("/proc/sys/kernel/sched_rt_runtime_us", "100000\n");
    EXPECT_EQ(check("rt_share").level, Level::warning);
    machine.write("/proc/sys/kernel/sched_rt_runtime_us", "-1\n");
    EXPECT_EQ(check("rt_share").level, Level::ok);
}

TEST_F(RealtimeChecks, more_work_than_cores_and_a_single_core_are_told) {
    machine.write("/proc/loadavg", "9.25 4.40 2.30 9/90 1\n");
    EXPECT_EQ(check("load").level, Level::warning);
    EXPECT_THAT(check("load").found, HasSubstr("9.2 of them busy"));
    machine.write("/proc/loadavg", "0.10 0.10 0.10 1/90 1\n");
    machine.cores = 1;
    EXPECT_EQ(check("load").level, Level::warning);
}

TEST_F(RealtimeChecks, the_system_and_a_virtual_machine_are_named) {
    machine.write("/etc/os-release", "NAME=\"Debian\"\nPRETTY_NAME=\"Debian GNU/Linux 12 (bookworm)\"\n");
    machine.write("/proc/sys/kernel/osrelease", "6.1.0-18-rt-amd64\n");
    machine.write("/sys/kernel/realtime", "1\n");
    machine.write("/proc/cpuinfo",
                  "processor\t: 0\nmodel name\t: Difference Engine\nflags\t\t: fpu hypervisor\n");
    EXPECT_EQ(check("system").found,
              "Debian GNU/Linux 12 (bookworm), Linux 6.1.0-18-rt-amd64 (PREEMPT_RT), Difference Engine");
    EXPECT_EQ(check("virtualisation").found, "a virtual machine");
}

TEST(ThisMachine, knows_itself) {
    const Machine machine = this_machine();
    EXPECT_FALSE(machine.host.empty());
    EXPECT_GE(machine.cores, 1U);
    EXPECT_GT(machine.clock_resolution_ns, 0);
    EXPECT_FALSE(machine.fifo.message.empty());
}

}  // namespace
}  // namespace palpate
