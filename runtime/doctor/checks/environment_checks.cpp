// SPDX-License-Identifier: Apache-2.0
#include "runtime/doctor/checks/environment_checks.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace palpate::doctor {
namespace {

constexpr const char* environment_group = "environment";

bool holds_device(const Machine& machine, const std::filesystem::path& folder) {
    std::error_code error;
    return std::filesystem::is_regular_file(in_root(machine, folder / "config/Default Device.config"), error);
}

// Devices set up under other names than "Default Device".
std::ptrdiff_t named_devices(const Machine& machine, const std::filesystem::path& folder) {
    std::error_code error;
    const std::filesystem::directory_iterator files(in_root(machine, folder / "config"), error);
    return std::count_if(begin(files), end(files),
                         [](const auto& file) { return file.path().extension() == ".config"; });
}

Finding driver_folder(const Machine& machine) {
    Finding finding{"device_config", environment_group, Level::problem, "", ""};
    const std::string asked = variable(machine, "GTDD_HOME");
    const std::filesystem::path of_user = machine.home / ".3dsystems",
                                of_root = machine.root_home / ".3dsystems";
    std::filesystem::path holder;
    for (const auto& folder : {std::filesystem::path("/usr/share/3DSystems"), of_user})
        if (holder.empty() && holds_device(machine, folder)) holder = folder;
    if (!asked.empty() && holds_device(machine, asked)) {
        finding.level = Level::ok;
        finding.found = fmt::format("{}/config/Default Device.config (GTDD_HOME)", asked);
    } else if (const auto named =
                   named_devices(machine, asked.empty() ? of_user : std::filesystem::path(asked));
               named > 0 && holder.empty()) {
        finding.level = Level::warning;
        finding.found = fmt::format("{} devices set up, none of them as 'Default Device'", named);
        finding.fix = "# open them by their names, or set one up as 'Default Device':\nbin/Touch_Setup";
    } else if (!asked.empty()) {
        finding.found = fmt::format("GTDD_HOME={} holds no 'config/Default Device.config'", asked);
        finding.fix = holder.empty()
                          ? "# run the driver's set-up as yourself, not with sudo:\nbin/Touch_Setup"
                          : fmt::format("export GTDD_HOME={0}; echo 'export GTDD_HOME={0}' >> ~/.profile",
                                        holder.string());
    } else if (!holder.empty()) {
        finding.level = Level::ok;
        finding.found = fmt::format("{}/config/Default Device.config", holder.string());
    } else if (of_user != of_root && holds_device(machine, of_root)) {
        finding.found = "only root has a 'Default Device.config': the device was set up with sudo";
        finding.fix = fmt::format("sudo cp -r {0} {1} && sudo chown -R {2}: {1}", of_root.string(),
                                  of_user.string(), machine.user);
    } else {
        finding.found = "no 'Default Device.config': no device has been set up by this user";
        finding.fix =
            "# with the device plugged in, in the folder of the unpacked Touch device driver, without sudo:\n"
            "export GTDD_HOME=$HOME/.3dsystems && bin/Touch_Setup\n"
            "# if it was set up with sudo, it is here: sudo ls ~root/.3dsystems/config";
    }
    return finding;
}

Finding locale(const Machine& machine) {
    std::string name = variable(machine, "LC_ALL");
    for (const char* next : {"LC_NUMERIC", "LANG"})
        if (name.empty()) name = variable(machine, next);
    if (name.empty()) name = "C";
    if (machine.decimal_point == '.')
        return {"locale", environment_group, Level::ok, name + ", decimal point", ""};
    return {"locale", environment_group, Level::warning,
            fmt::format("{} writes numbers with '{}'; device drivers then misread their settings", name,
                        machine.decimal_point),
            "unset LC_ALL; export LC_NUMERIC=C"};
}

Finding display(const Machine& machine) {
    const std::string name = variable(machine, "DISPLAY");
    if (!name.empty())
        return {"display", environment_group, Level::ok, name.starts_with(':') ? name : "of another machine",
                ""};
    return {"display", environment_group, Level::warning,
            "no DISPLAY: 'train' has no window, 'touch' needs none",
            "# log in to a desktop, or give it a screen that nobody sees:\n"
            "sudo apt install xvfb && xvfb-run palpate train case.vtkhdf"};
}

}  // namespace

Findings environment_findings(const Machine& machine, Purpose purpose) {
    Findings findings{locale(machine), display(machine)};
    if (purpose == Purpose::device) findings.push_back(driver_folder(machine));
    return findings;
}

Findings usb_findings(const Machine& machine, const std::vector<UsbDevice>& devices) {
    Findings findings;
    for (const UsbDevice& device : devices) {
        const std::string id = findings.empty() ? "usb" : fmt::format("usb.{}", findings.size() + 1);
        Finding finding{id, environment_group, Level::ok, device.id + " at " + device.node, ""};
        if (device.node.empty()) {
            finding.level = Level::problem;
            finding.found = device.id + " is plugged in, but the kernel made no /dev node of it";
            finding.fix = "sudo modprobe cdc_acm && sudo modprobe usbhid\n# then plug it in again";
        } else if (!device.may_use) {
            finding.level = Level::problem;
            finding.found += ", which this user may not read and write";
            finding.fix = fmt::format(
                "printf '%s\\n' 'SUBSYSTEM==\"tty|hidraw\", ATTRS{{idVendor}}==\"{}\", GROUP=\"plugdev\", "
                "MODE=\"0660\"' | sudo tee /etc/udev/rules.d/99-palpate-device.rules\n"
                "sudo udevadm control --reload && sudo udevadm trigger\n"
                "sudo adduser {} plugdev\n# then log out and in again",
                device.id.substr(0, 4), machine.user);
        }
        findings.push_back(std::move(finding));
    }
    if (findings.empty())
        findings.push_back({"usb", environment_group, Level::warning,
                            "no Phantom on USB; one on Ethernet or FireWire is not seen from here",
                            "# plug the device in, switch it on, and look for it:\nlsusb | grep 2988"});
    return findings;
}

}  // namespace palpate::doctor
