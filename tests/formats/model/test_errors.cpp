// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

TEST(Errors, a_message_has_the_parts_that_there_are) {
    EXPECT_EQ(to_string({"a.nrrd", "has no label", "one", "segment it"}),
              "a.nrrd: has no label (expected one); segment it");
    EXPECT_EQ(to_string({"a.nrrd", "has no label", "", ""}), "a.nrrd: has no label");
    EXPECT_EQ(to_string({"a.nrrd", "", "one", ""}), "a.nrrd (expected one)");
    EXPECT_EQ(to_string({"", "no label", "", "segment it"}), "no label; segment it");
    const QualityNotMet error({.culprit = "liver", .found = "angle 4", .expected = "10", .next_step = ""});
    EXPECT_STREQ(error.what(), "liver: angle 4 (expected 10)");
    EXPECT_EQ(error.detail().expected, "10");
}

TEST(SmallFile, is_one_of_no_more_bytes_than_asked_or_absent) {
    const sample::Scratch scratch;
    std::ofstream(scratch / "four") << "1234";
    EXPECT_EQ(sample::refusal([&] { require_small_file(scratch / "four", 4); }), "");
    EXPECT_EQ(sample::refusal([&] { require_small_file(scratch / "gone", 4); }), "");
    EXPECT_EQ(sample::refusal([&] { require_small_file(scratch / "four", 3); }),
              (scratch / "four").string() +
                  ": has 4 bytes (expected 3 at most); check that it is the file you mean");
    EXPECT_EQ(sample::refusal([&] { require_small_file(scratch.path(), 4); }),
              scratch.path().string() + ": is a folder (expected a file); check the path");
    EXPECT_EQ(sample::refusal([] { require_small_file("/dev/zero", 4); }),
              "/dev/zero: is a device (expected a file); check the path");
}

}  // namespace
}  // namespace palpate
