// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "runtime/doctor/report.hpp"
#include "tests/runtime/doctor/made_up_machine.hpp"

namespace palpate {
namespace {

using namespace doctor;

TEST(Report, groups_findings_under_headings_with_fixes_below) {
    const Findings findings{{"fifo", "real time", Level::problem, "refused", "sudo this\n# then that"},
                            {"load", "real time", Level::ok, "none", ""},
                            {"usb", "environment", Level::warning, "no device", ""}};
    EXPECT_EQ(report_text(findings),
              "real time\n"
              "  problem  fifo  refused\n"
              "      sudo this\n"
              "      # then that\n"
              "  ok       load  none\n"
              "environment\n"
              "  warning  usb   no device\n");
    EXPECT_EQ(count(findings, Level::problem), 1U);
}

TEST(Report, json_for_support_names_neither_user_nor_home_nor_host) {
    const sample::MadeUpMachine machine;  // ada, /home/ada, engine
    const Findings findings{{"library", "device library", Level::problem,
                             "/home/ada/lib/libHD.so on engine, copied from /home/lovelace/x",
                             "printf 'ada - rtprio 99' && sudo chown -R ada: /home/ada/.3dsystems"}};
    const auto row = report_json(findings, machine).at(0);
    EXPECT_EQ(row.at("found"), "~/lib/libHD.so on $HOSTNAME, copied from ~/x");
    EXPECT_EQ(row.at("fix"), "printf '$USER - rtprio 99' && sudo chown -R $USER: ~/.3dsystems");
    EXPECT_EQ(row.at("level"), "problem");
}

TEST(Report, a_name_within_a_word_stays) {
    const sample::MadeUpMachine machine;
    EXPECT_EQ(anonymous("adapter of ada-lib, adams, Canada; ada.", machine),
              "adapter of ada-lib, adams, Canada; $USER.");
    EXPECT_EQ(anonymous("/home/adam/x /home/ada/y", machine), "~/x ~/y");
}

TEST(Report, a_home_that_is_the_root_or_unknown_changes_nothing) {
    sample::MadeUpMachine machine;
    machine.user = machine.host = "";
    for (const char* home : {"", "/"}) {
        machine.home = home;
        EXPECT_EQ(anonymous("/usr/lib/libHD.so", machine), "/usr/lib/libHD.so");
    }
}

}  // namespace
}  // namespace palpate
