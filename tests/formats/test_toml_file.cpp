// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/toml_file/parse_file.hpp"
#include "formats/toml_file/quoted.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using ::testing::HasSubstr;

std::string repeated(const std::string& text, int times) {
    std::string all;
    for (int n = 0; n < times; ++n) all += text;
    return all;
}

// What a file is refused with, "" if it is read.
std::string outcome(const std::string& text) {
    const sample::Scratch scratch;
    std::ofstream(scratch / "a.toml") << text;
    return sample::refusal([&] { toml_file::parse_file(scratch / "a.toml", "correct it"); });
}

TEST(TomlFile, a_quoted_text_is_read_back) {
    for (const std::string text : {"a \"b\" \\c", "line\nfeed\tand bell\a", "it's", "L\xc3\xa4"}) {
        const toml::table table = toml_file::parse_text("a = " + toml_file::quoted(text), "x.toml", "");
        EXPECT_EQ(table["a"].value<std::string>(), text);
    }
}

TEST(TomlFile, that_is_none_is_refused_with_where_it_goes_wrong_and_what_to_do) {
    const sample::Scratch scratch;
    const auto refusal = [&](const std::string& name) {
        return sample::refusal([&] { toml_file::parse_file(scratch / name, "correct it"); });
    };
    EXPECT_EQ(refusal("gone.toml"), (scratch / "gone.toml").string() + ": cannot be read; check the path");
    std::filesystem::create_directory(scratch / "folder");
    EXPECT_EQ(refusal("folder"),
              (scratch / "folder").string() + ": is a folder (expected a file); check the path");
    std::ofstream(scratch / "large.toml") << std::string((1 << 20) + 1, '#');
    EXPECT_THAT(refusal("large.toml"),
                HasSubstr("large.toml: has 1048577 bytes (expected 1048576 at most); check that"));
    const std::string broken = outcome("a = 1\nb = = 2\n");
    EXPECT_THAT(broken, HasSubstr("a.toml:2: "));
    EXPECT_THAT(broken, ::testing::EndsWith("; correct it"));
}

TEST(TomlFile, full_stops_of_numbers_texts_and_comments_are_free) {
    EXPECT_EQ(outcome("places_mm = [" + repeated("[1.25, -2.5e0, +3.0],\n", 1366) + "]\n"), "");
    EXPECT_EQ(outcome("at = 1.5 # " + repeated("...", 2000) + "\nb = 0.5\n"), "");
    for (const char* mark : {"\"", "'", "\"\"\"", "'''"})
        EXPECT_EQ(outcome(std::string("a = ") + mark + repeated(".", 5000) + mark + "\n"), "") << mark;
    EXPECT_EQ(outcome("a = \"\\\"" + repeated(".", 5000) + "\"\n"), "");
    EXPECT_EQ(outcome("a = \"\"\"" + repeated("It ends. \n\"\" Or \\\"\"\".\n", 2500) + "\"\"\"\"\"\n"), "");
    EXPECT_EQ(outcome(repeated("[[e]]\nf.a = 0.5\nf.b = 2023-01-01T00:00:00.5Z\n", 2000)), "");
}

TEST(TomlFile, keys_may_not_nest_by_more_full_stops_than_4096) {
    const std::string deep = repeated(".a", 5000), digits = repeated(".1", 5000);
    for (const std::string& text :
         {"a" + deep + " = 1\n", "[a" + deep + "]\n", "[[a" + deep + "]]\n", "x = {a" + deep + " = 1}\n",
          "x = [\"\"\"a\"\"\"\"\", {a" + deep + " = 1}]\n", "x = '''a''''\ny = 1\na" + deep + " = 1\n",
          "1" + digits + " = 1\n", "[1" + digits + "]\n", repeated("1.1 . ", 5000) + "1 = 1\n",
          repeated("\"a\".", 5000) + "b = 1\n", repeated("'a' . ", 5000) + "b = 1\n",
          "x = {y = 1.5, a" + deep + " = 1}\n", "x = \"#\"\na" + deep + " = '#'\n"})
        EXPECT_THAT(outcome(text), HasSubstr("full stops in keys (expected 4096 at most"))
            << text.substr(0, 40);
}

}  // namespace
}  // namespace palpate
