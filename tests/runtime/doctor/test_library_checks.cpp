// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/doctor/checks/library_checks.hpp"
#include "runtime/doctor/loader.hpp"
#include "tests/runtime/doctor/made_up_machine.hpp"

namespace palpate {
namespace {

using namespace doctor;
using sample::find;
using ::testing::HasSubstr;

struct LibraryChecks : testing::Test {
    sample::MadeUpMachine machine;

    void install(const std::string& stub, const std::string& path) {
        machine.copy(std::filesystem::path(DOCTOR_STUBS) / stub, path);
    }
    void install_all() {
        install("libHD.so.3.4", "/usr/lib/libHD.so.3.4");
        install("libncurses.so.5", "/usr/lib/x86_64-linux-gnu/libncurses.so.5");
        install("libtinfo.so.5", "/lib/x86_64-linux-gnu/libtinfo.so.5");
        install("libPhantomIOLib.so.42", "/usr/lib/libPhantomIOLib.so.42");
    }
};

TEST_F(LibraryChecks, a_machine_without_a_library_is_told_where_to_get_one) {
    const Findings findings = library_findings(machine);
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_EQ(findings[0].level, Level::problem);
    EXPECT_THAT(findings[0].fix, HasSubstr("https://support.3dsystems.com/"));
    EXPECT_THAT(findings[0].fix, HasSubstr("palpate doctor --simulated"));
}

TEST_F(LibraryChecks, a_whole_installation_has_no_problem) {
    install_all();
    const Findings findings = library_findings(machine);
    EXPECT_EQ(count(findings, Level::ok), findings.size());
    EXPECT_EQ(find(findings, "library").found, "/usr/lib/libHD.so.3.4");
    EXPECT_EQ(find(findings, "needs").found, "3 libraries, all there");
}

TEST_F(LibraryChecks, a_missing_library_and_one_that_another_needs_are_named_with_their_packages) {
    install_all();
    std::filesystem::remove(in_root(machine, "/usr/lib/x86_64-linux-gnu/libncurses.so.5"));
    std::filesystem::remove(in_root(machine, "/lib/x86_64-linux-gnu/libtinfo.so.5"));
    const Findings findings = library_findings(machine);
    EXPECT_EQ(count(findings, Level::problem), 2U);
    EXPECT_EQ(find(findings, "needs.libncurses.so.5").fix, "sudo apt install libncurses5");
    const Finding tinfo = find(findings, "needs.libtinfo.so.5");
    EXPECT_EQ(tinfo.fix, "sudo apt install libtinfo5");
    EXPECT_EQ(tinfo.found, "libPhantomIOLib.so.42 needs libtinfo.so.5: not installed");
}

TEST_F(LibraryChecks, a_missing_driver_is_told_where_to_get_it) {
    install_all();
    std::filesystem::remove(in_root(machine, "/usr/lib/libPhantomIOLib.so.42"));
    EXPECT_THAT(find(library_findings(machine), "needs.libPhantomIOLib.so.42").fix,
                HasSubstr("sudo ./install_haptic_driver"));
}

TEST_F(LibraryChecks, a_folder_that_a_library_names_itself_is_searched) {
    install_all();
    const auto driver = in_root(machine, "/usr/lib/driver");
    std::filesystem::create_directory(driver);
    std::filesystem::rename(in_root(machine, "/usr/lib/libPhantomIOLib.so.42"),
                            driver / "libPhantomIOLib.so.42");
    EXPECT_EQ(count(library_findings(machine), Level::problem), 0U);
}

TEST_F(LibraryChecks, a_library_where_the_loader_does_not_look_is_found_by_a_longer_name_too) {
    install_all();
    std::filesystem::remove(in_root(machine, "/usr/lib/libPhantomIOLib.so.42"));
    install("libPhantomIOLib.so.42", "/usr/lib64/libPhantomIOLib.so.42.1");
    const Finding finding = find(library_findings(machine), "needs.libPhantomIOLib.so.42");
    EXPECT_EQ(finding.level, Level::problem);
    EXPECT_THAT(finding.found, HasSubstr("/usr/lib64/libPhantomIOLib.so.42.1 is there, but the loader"));
    EXPECT_EQ(finding.fix,
              "echo /usr/lib64 | sudo tee -a /etc/ld.so.conf.d/palpate-device.conf && sudo ldconfig");
}

TEST_F(LibraryChecks, a_configured_folder_counts_once_the_cache_knows_it) {
    machine.write("/etc/ld.so.conf", "include /etc/ld.so.conf.d/*.conf\n");
    machine.write("/etc/ld.so.conf.d/libc.conf", "# libc default configuration\n/usr/local/lib\n");
    install("libHD.so.3.4", "/usr/local/lib/libHD.so.3.4");
    const Finding unknown = find(library_findings(machine), "library");
    EXPECT_EQ(unknown.level, Level::problem);
    EXPECT_EQ(unknown.fix, "sudo ldconfig");
    machine.write("/etc/ld.so.cache", std::string("glibc-ld.so.cache1.1\0/usr/local/lib/libHD.so.3.4\0", 50));
    EXPECT_EQ(find(library_findings(machine), "library").level, Level::ok);
}

TEST_F(LibraryChecks, the_loaders_own_variable_comes_first) {
    install_all();
    install("libHD.so.3.4", "/opt/device/libHD.so.3.4");
    machine.environment["LD_LIBRARY_PATH"] = "/nowhere:/opt/device";
    EXPECT_EQ(find(library_findings(machine), "library").found, "/opt/device/libHD.so.3.4");
}

TEST_F(LibraryChecks, the_users_own_path_wins_and_is_named_where_it_is_wrong) {
    install_all();
    machine.environment["PALPATE_HD_LIBRARY"] = "/home/ada/libHD.so";
    const Finding missing = find(library_findings(machine), "library");
    EXPECT_EQ(missing.level, Level::problem);
    EXPECT_THAT(missing.found, HasSubstr("PALPATE_HD_LIBRARY=/home/ada/libHD.so"));
    EXPECT_THAT(missing.fix, HasSubstr("unset PALPATE_HD_LIBRARY"));
    install("libHD.so.3.4", "/home/ada/libHD.so");
    EXPECT_EQ(find(library_findings(machine), "library").found, "/home/ada/libHD.so");
}

TEST_F(LibraryChecks, a_library_of_another_architecture_is_passed_over) {
    machine.write("/usr/lib/libHD.so.3.4", std::string("\177ELF\1\1\1\0\0\0\0\0\0\0\0\0\3\0\3\0", 20));
    const Finding finding = find(library_findings(machine), "library");
    EXPECT_EQ(finding.level, Level::problem);
    EXPECT_THAT(finding.found, HasSubstr("is of another architecture (i386, 32 bit)"));
    install("libHD.so.3.4", "/usr/lib/libHD.so");
    EXPECT_EQ(find(library_findings(machine), "library").found, "/usr/lib/libHD.so");
}

TEST_F(LibraryChecks, a_damaged_library_is_named) {
    machine.write("/usr/lib/libHD.so.3.4", "too short");
    EXPECT_THAT(find(library_findings(machine), "library").found,
                HasSubstr("/usr/lib/libHD.so.3.4 ends before what it announces"));
}

TEST_F(LibraryChecks, configurations_that_include_each_other_end) {
    machine.write("/etc/ld.so.conf", "include /etc/ld.so.conf\ninclude /etc/*.conf\n/usr/local/lib\n");
    EXPECT_FALSE(find_library(machine, "libHD.so").has_value());
}

}  // namespace
}  // namespace palpate
