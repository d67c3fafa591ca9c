// SPDX-License-Identifier: Apache-2.0
#include "runtime/doctor/checks/library_checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

#include "runtime/devices/openhaptics/hd_library.hpp"
#include "runtime/doctor/loader.hpp"

namespace palpate::doctor {
namespace {

using namespace devices;

using Standing = LibraryPlace::Standing;
constexpr const char* library_group = "device library";
constexpr const char* maker =
    "https://support.3dsystems.com/s/article/OpenHaptics-for-Linux-Developer-Edition-v34";

// What brings a library that the device library is known to need, on Debian 12.
std::string source_of(const std::string& name) {
    if (name == "libncurses.so.5") return "sudo apt install libncurses5";
    if (name == "libtinfo.so.5") return "sudo apt install libtinfo5";
    if (name.starts_with("libPhantomIOLib"))
        return fmt::format(
            "# get the Touch device driver from\n# {}\n# unpack it, and in its folder:\n"
            "sudo ./install_haptic_driver && sudo ldconfig",
            maker);
    if (name.starts_with("libPHANToMIO"))
        return "# it comes with the PHANTOM Device Drivers 4.3 of OpenHaptics 3.0; in their folder "
               "'64-bit':\n"
               "sudo dpkg -i phantomdevicedrivers_4.3-3_amd64.deb && sudo ldconfig";
    return fmt::format(
        "sudo apt install apt-file && sudo apt-file update && apt-file search {}\n"
        "# then install the package it names",
        name);
}

std::string fix_of(const LibraryPlace& place, const std::string& name) {
    switch (place.standing) {
        case Standing::loads:
            return "";
        case Standing::not_cached:
            return "sudo ldconfig";
        case Standing::off_path:
            return fmt::format("echo {} | sudo tee -a /etc/ld.so.conf.d/palpate-device.conf && sudo ldconfig",
                               place.file.parent_path().string());
        case Standing::other_machine:
        case Standing::damaged:
            break;
    }
    return source_of(name);
}

std::string told(const LibraryPlace& place) {
    const std::string file = place.file.string();
    switch (place.standing) {
        case Standing::loads:
            return file;
        case Standing::not_cached:
            return file + " is there, but the loader's cache does not know it";
        case Standing::off_path:
            return file + " is there, but the loader does not look there";
        case Standing::other_machine:
            return file + " is of another architecture (" + place.reason + ")";
        case Standing::damaged:
            break;
    }
    return file + " " + place.reason;
}

std::string get_library() {
    return fmt::format(
        "# get OpenHaptics for Linux and the Touch device driver from\n# {}\n"
        "# unpack both; nothing else is needed, no headers and no SDK build. In the folder of each:\n"
        "sudo ./install\nsudo ./install_haptic_driver && sudo ldconfig\n"
        "# a library elsewhere: export {}=/path/to/libHD.so.3.4\n"
        "# no device, only the simulated one: palpate doctor --simulated",
        maker, hd_library_variable);
}

// The library to be loaded, or the next best with what is wrong.
std::optional<LibraryPlace> device_library(const Machine& machine) {
    std::optional<LibraryPlace> second_best;
    for (const char* name : hd_library_names()) {
        const auto place = find_library(machine, name);
        if (place && place->standing == Standing::loads) return place;
        if (place && !second_best) second_best = place;
    }
    return second_best;
}

Finding library_finding(const std::optional<LibraryPlace>& place, const std::string& asked) {
    Finding finding{"library", library_group, Level::problem, "", ""};
    if (!place && asked.empty()) {
        finding.found = fmt::format("none: looked for {}", fmt::join(hd_library_names(), ", "));
        finding.fix = get_library();
    } else if (!place) {
        finding.found = fmt::format("{}={}: no such library", hd_library_variable, asked);
        finding.fix = fmt::format("# name the library's own file, or let it be looked for:\nunset {}",
                                  hd_library_variable);
    } else {
        finding.level = place->standing == Standing::loads ? Level::ok : Level::problem;
        finding.found = told(*place);
        const bool unusable =
            place->standing == Standing::other_machine || place->standing == Standing::damaged;
        finding.fix = unusable ? get_library() : fix_of(*place, place->file.filename().string());
    }
    return finding;
}

// Needs of `library`, and their own once, each library asked for only once.
struct Needs {
    const Machine& machine;
    Findings missing{};
    std::set<std::string> seen{};

    void add(const LibraryPlace& library, bool and_theirs) {
        for (const std::string& name : library.elf.needed) {
            if (!seen.insert(name).second) continue;
            const auto place = name.find('/') == std::string::npos
                                   ? find_library(machine, name, run_folders_of(library))
                                   : library_at(machine, name);
            if (place && place->standing == Standing::loads) {
                if (and_theirs) add(*place, false);
                continue;
            }
            missing.push_back({"needs." + name, library_group, Level::problem,
                               fmt::format("{} needs {}: {}", library.file.filename().string(), name,
                                           place ? told(*place) : "not installed"),
                               place ? fix_of(*place, name) : source_of(name)});
        }
    }
};

}  // namespace

Findings library_findings(const Machine& machine) {
    const std::string asked = variable(machine, hd_library_variable);
    const auto library = asked.empty() ? device_library(machine)
                         : asked.find('/') == std::string::npos
                             ? find_library(machine, asked)
                             : library_at(machine, std::filesystem::absolute(asked));
    Findings findings{library_finding(library, asked)};
    if (!library || library->standing != Standing::loads) return findings;
    Needs needs{machine};
    needs.add(*library, true);
    if (needs.missing.empty())
        findings.push_back({"needs", library_group, Level::ok,
                            fmt::format("{} libraries, all there", needs.seen.size()), ""});
    findings.insert(findings.end(), needs.missing.begin(), needs.missing.end());
    return findings;
}

}  // namespace palpate::doctor
