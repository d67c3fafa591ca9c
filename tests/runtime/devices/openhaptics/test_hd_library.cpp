// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>

#include "formats/model/errors.hpp"
#include "runtime/devices/openhaptics/hd_library.hpp"
#include "runtime/devices/openhaptics/hd_session.hpp"

namespace palpate {
namespace {

using namespace devices;
using ::testing::HasSubstr;

template <class Wanted, class Function>
ErrorDetail detail_of(const Function& function) {
    try {
        function();
    } catch (const Wanted& error) {
        return error.detail();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

// The loader's environment for one test.
class LibraryVariable {
  public:
    explicit LibraryVariable(const char* path) { setenv(hd_library_variable, path, 1); }
    LibraryVariable(const LibraryVariable&) = delete;
    LibraryVariable& operator=(const LibraryVariable&) = delete;
    ~LibraryVariable() { unsetenv(hd_library_variable); }
};

ErrorDetail explain_missing(const std::string& file) {
    return explain_load_error("libHD.so.3.4",
                              file + ": cannot open shared object file: No such file or directory");
}

TEST(HdLibrary, newest_release_is_tried_first) {
    ASSERT_EQ(hd_library_names().size(), 3u);
    EXPECT_STREQ(hd_library_names()[0], "libHD.so.3.4");
    EXPECT_STREQ(hd_library_names()[1], "libHD.so");
    EXPECT_STREQ(hd_library_names()[2], "libHD.so.3.0");
}

TEST(HdLibrary, each_known_dependency_is_named_with_the_package_that_has_it) {
    EXPECT_THAT(explain_missing("libncurses.so.5").next_step, HasSubstr("libncurses5"));
    EXPECT_THAT(explain_missing("libtinfo.so.5").next_step, HasSubstr("libtinfo5"));
    EXPECT_THAT(explain_missing("libPHANToMIO.so.4").next_step, HasSubstr("Phantom Device Drivers"));
    EXPECT_THAT(explain_missing("libPhantomIOLib42.so").next_step, HasSubstr("Touch device driver"));
    EXPECT_THAT(explain_missing("libPhantomIOLib42.so").found, HasSubstr("libPhantomIOLib42.so"));
}

TEST(HdLibrary, an_unknown_dependency_is_named) {
    const ErrorDetail detail = explain_missing("libraw1394.so.11");
    EXPECT_THAT(detail.found, HasSubstr("libraw1394.so.11"));
    EXPECT_THAT(detail.next_step, HasSubstr("libraw1394.so.11"));
}

TEST(HdLibrary, a_library_that_is_not_there_is_told_from_one_that_lacks_a_dependency) {
    EXPECT_EQ(explain_missing("libHD.so.3.4").found, "not found");
    EXPECT_THAT(explain_missing("libHD.so.3.4").next_step, HasSubstr("PALPATE_HD_LIBRARY"));
}

TEST(HdLibrary, other_loader_errors_name_a_fix) {
    for (const char* message :
         {"libHD.so: wrong ELF class: ELFCLASS32", "libHD.so: undefined symbol: pdd_open",
          "libHD.so: cannot open shared object file: Permission denied", "libHD.so: file too short",
          "libHD.so: something new"}) {
        const ErrorDetail detail = explain_load_error("libHD.so", message);
        EXPECT_FALSE(detail.found.empty()) << message;
        EXPECT_FALSE(detail.next_step.empty()) << message;
    }
}

TEST(HdLibrary, a_users_path_that_is_not_there_is_invalid_input) {
    const ErrorDetail detail = detail_of<InvalidInput>([] { load_hd_library("/nowhere/libHD.so"); });
    EXPECT_EQ(detail.culprit, "/nowhere/libHD.so");
    EXPECT_EQ(detail.found, "not found");
    EXPECT_THAT(detail.next_step, HasSubstr("check the path"));
}

TEST(HdLibrary, the_environment_names_the_library_where_no_path_is_given) {
    const LibraryVariable variable("/nowhere/of/the/environment.so");
    EXPECT_EQ(detail_of<InvalidInput>([] { load_hd_library({}); }).culprit, "/nowhere/of/the/environment.so");
    EXPECT_EQ(detail_of<InvalidInput>([] { load_hd_library("/nowhere/libHD.so"); }).culprit,
              "/nowhere/libHD.so");
}

TEST(HdLibrary, the_first_function_that_a_library_lacks_is_named) {
    const ErrorDetail detail = detail_of<InvalidInput>([] { load_hd_library(PALPATE_HD_WITHOUT_SYMBOLS); });
    EXPECT_EQ(detail.culprit, PALPATE_HD_WITHOUT_SYMBOLS);
    EXPECT_THAT(detail.found, HasSubstr("hdDisableDevice"));
}

TEST(HdLibrary, a_file_that_is_no_library_is_invalid_input) {
    const auto file = std::filesystem::temp_directory_path() / "palpate_no_library.so";
    std::ofstream(file)
        << "this is text, and long enough to hold what a library's header would hold: 0123456789";
    const ErrorDetail detail = detail_of<InvalidInput>([&] { load_hd_library(file); });
    std::filesystem::remove(file);
    EXPECT_THAT(detail.found, HasSubstr("not a shared library"));
}

TEST(HdSession, refuses_names_that_are_empty_or_named_twice_before_it_loads_anything) {
    EXPECT_THAT(detail_of<InvalidInput>([] {
                    HdSession({"/nowhere/libHD.so", {""}});
                }).found,
                HasSubstr("empty name"));
    EXPECT_THAT(detail_of<InvalidInput>([] {
                    HdSession({"/nowhere/libHD.so", {"Left", "Left"}});
                }).found,
                HasSubstr("'Left' is named twice"));
    EXPECT_EQ(detail_of<InvalidInput>([] {
                  HdSession({"/nowhere/libHD.so", {"Left", "Right"}});
              }).culprit,
              "/nowhere/libHD.so");
}

}  // namespace
}  // namespace palpate
