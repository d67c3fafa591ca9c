// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/doctor/checks/environment_checks.hpp"
#include "tests/runtime/doctor/made_up_machine.hpp"

namespace palpate {
namespace {

using namespace doctor;
using sample::find;
using ::testing::HasSubstr;

struct EnvironmentChecks : testing::Test {
    sample::MadeUpMachine machine;

    Finding check(const std::string& id) const {
        return find(environment_findings(machine, Purpose::device), id);
    }
    // As the kernel shows it: the port is a link to where the device hangs.
    void plug_in(const std::string& port, const std::string& vendor, const std::string& product,
                 const std::string& node_folder) {
        const std::string device = "/sys/devices/pci0/usb1/" + port;
        machine.write(device + "/idVendor", vendor + "\n");
        machine.write(device + "/idProduct", product + "\n");
        if (!node_folder.empty()) machine.write(device + "/" + node_folder + "/dev", "166:0\n");
        const auto bus = in_root(machine, "/sys/bus/usb/devices");
        std::filesystem::create_directories(bus);
        std::filesystem::create_symlink("../../../devices/pci0/usb1/" + port, bus / port);
    }
};

TEST_F(EnvironmentChecks, a_simulation_needs_no_driver_folder) {
    EXPECT_EQ(find(environment_findings(machine, Purpose::simulation), "device_config").id, "");
}

TEST_F(EnvironmentChecks, a_device_set_up_by_the_user_is_found) {
    machine.write("/home/ada/.3dsystems/config/Default Device.config", "");
    EXPECT_EQ(check("device_config").level, Level::ok);
}

TEST_F(EnvironmentChecks, a_device_set_up_for_everybody_is_found) {
    machine.write("/usr/share/3DSystems/config/Default Device.config", "");
    EXPECT_EQ(check("device_config").found, "/usr/share/3DSystems/config/Default Device.config");
}

TEST_F(EnvironmentChecks, a_device_set_up_with_sudo_is_copied_to_its_user) {
    machine.write("/superuser/.3dsystems/config/Default Device.config", "");
    EXPECT_EQ(check("device_config").level, Level::problem);
    EXPECT_EQ(
        check("device_config").fix,
        "sudo cp -r /superuser/.3dsystems /home/ada/.3dsystems && sudo chown -R ada: /home/ada/.3dsystems");
}

TEST_F(EnvironmentChecks, a_variable_that_leads_astray_is_set_right) {
    machine.environment["GTDD_HOME"] = "/opt/old";
    EXPECT_EQ(check("device_config").level, Level::problem);
    machine.write("/home/ada/.3dsystems/config/Default Device.config", "");
    EXPECT_THAT(check("device_config").fix, HasSubstr("export GTDD_HOME=/home/ada/.3dsystems"));
    machine.write("/opt/old/config/Default Device.config", "");
    EXPECT_EQ(check("device_config").level, Level::ok);
}

TEST_F(EnvironmentChecks, devices_under_other_names_only_are_a_warning) {
    machine.write("/home/ada/.3dsystems/config/Left.config", "");
    machine.write("/home/ada/.3dsystems/config/Right.config", "");
    EXPECT_EQ(check("device_config").level, Level::warning);
    EXPECT_THAT(check("device_config").found, HasSubstr("2 devices set up"));
}

TEST_F(EnvironmentChecks, a_decimal_comma_is_a_warning_that_names_the_locale_which_counts) {
    machine.environment = {{"LANG", "en_GB.UTF-8"}, {"LC_NUMERIC", "de_DE.UTF-8"}};
    EXPECT_EQ(check("locale").level, Level::ok);
    machine.decimal_point = ',';
    EXPECT_EQ(check("locale").level, Level::warning);
    EXPECT_THAT(check("locale").found, HasSubstr("de_DE.UTF-8"));
    EXPECT_EQ(check("locale").fix, "unset LC_ALL; export LC_NUMERIC=C");
}

TEST_F(EnvironmentChecks, a_missing_display_is_a_warning) {
    EXPECT_EQ(check("display").level, Level::warning);
    machine.environment["DISPLAY"] = ":0";
    EXPECT_EQ(check("display").level, Level::ok);
}

TEST_F(EnvironmentChecks, phantoms_are_found_with_their_nodes_among_other_usb_devices) {
    plug_in("1-1", "046d", "c077", "1-1:1.0/0003:046D:C077.0001/hidraw/hidraw0");
    plug_in("1-2", "2988", "0304", "1-2:1.0/0003:2988:0304.0002/hidraw/hidraw1");
    plug_in("1-3", "0301", "2988", "1-3:1.0/tty/ttyACM0");
    plug_in("1-4", "2988", "0302", "");
    const auto devices = find_usb_devices(machine);
    ASSERT_EQ(devices.size(), 3U);
    EXPECT_EQ(devices[0].id, "2988:0304");
    EXPECT_EQ(devices[0].node, "/dev/hidraw1");
    EXPECT_EQ(devices[1].node, "/dev/ttyACM0");
    EXPECT_EQ(devices[2].node, "");
    EXPECT_FALSE(devices[0].may_use);
    machine.write("/dev/hidraw1", "");
    EXPECT_TRUE(find_usb_devices(machine)[0].may_use);
}

TEST_F(EnvironmentChecks, a_device_that_the_user_may_not_use_comes_with_its_rule) {
    const Finding finding = find(usb_findings(machine, {{"2988:0302", "/dev/ttyACM0", false}}), "usb");
    EXPECT_EQ(finding.level, Level::problem);
    EXPECT_THAT(finding.fix, HasSubstr("'SUBSYSTEM==\"tty|hidraw\", ATTRS{idVendor}==\"2988\", "
                                       "GROUP=\"plugdev\", MODE=\"0660\"' | sudo tee /etc/udev/rules.d/"));
    EXPECT_THAT(finding.fix, HasSubstr("sudo adduser ada plugdev"));
}

TEST_F(EnvironmentChecks, usb_devices_in_use_without_node_and_absent_differ) {
    EXPECT_EQ(find(usb_findings(machine, {{"2988:0302", "/dev/ttyACM0", true}}), "usb").level, Level::ok);
    EXPECT_EQ(find(usb_findings(machine, {{"2988:0302", "", false}}), "usb").level, Level::problem);
    EXPECT_EQ(find(usb_findings(machine, {}), "usb").level, Level::warning);
    const UsbDevice device{"2988:0302", "/dev/ttyACM0", true};
    EXPECT_EQ(usb_findings(machine, {device, device})[1].id, "usb.2");
}

}  // namespace
}  // namespace palpate
