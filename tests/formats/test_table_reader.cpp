// SPDX-License-Identifier: Apache-2.0
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/toml_file/parse_file.hpp"
#include "formats/toml_file/table_reader.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace toml_file;
using ::testing::ElementsAre;

// What reading a file of that text is refused with, "" if it is not.
std::string refusal_of(const std::string& text, const std::function<void(TableReader&)>& read) {
    const toml::table table = parse_text(text, "case.toml", "");
    TableReader reader(table, "case.toml", "");
    return sample::refusal([&] { read(reader); });
}

TEST(TableReader, reads_values_as_they_were_written_and_knows_what_is_absent) {
    const toml::table table = parse_text(
        "name = 'liver'\ncount = 3\nsize_mm = 1.5\nheld = true\nplace_mm = [1, 2.5, -3]\n", "case.toml", "");
    TableReader reader(table, "case.toml", "");
    EXPECT_EQ(reader.required<std::string>("name"), "liver");
    EXPECT_EQ(reader.required<std::int64_t>("count"), 3);
    EXPECT_EQ(reader.required<double>("count"), 3);
    EXPECT_EQ(reader.required_positive("size_mm"), 1.5);
    EXPECT_EQ(reader.optional<bool>("held"), true);
    EXPECT_EQ(reader.text_or_number("name"), "liver");
    EXPECT_EQ(reader.text_or_number("count"), "3");
    EXPECT_EQ(reader.choice("name", {"kidney", "liver"}), "liver");
    EXPECT_THAT(reader.numbers("place_mm", 3), ElementsAre(1, 2.5, -3));
    EXPECT_THAT(*reader.optional_numbers("place_mm", 3), ElementsAre(1, 2.5, -3));

    EXPECT_TRUE(reader.has("name"));
    EXPECT_FALSE(reader.has("gone"));
    EXPECT_FALSE(reader.optional<double>("gone"));
    EXPECT_FALSE(reader.text_or_number("gone"));
    EXPECT_FALSE(reader.choice("gone", {"kidney"}));
    EXPECT_FALSE(reader.path("gone"));
    EXPECT_FALSE(reader.positive("gone"));
    EXPECT_FALSE(reader.optional_numbers("gone", 3));
    EXPECT_TRUE(reader.list("gone").empty());
    EXPECT_TRUE(reader.tables("gone").empty());
    EXPECT_FALSE(reader.table("gone").has("name"));
}

TEST(TableReader, names_line_and_key_of_a_value_of_another_type_and_what_was_expected) {
    const std::string text = "a = 1\n\n[b]\nc = 'x'\n";
    const auto refusal = [&](const std::function<void(TableReader&)>& read) {
        return refusal_of(text, read);
    };
    EXPECT_EQ(refusal([](TableReader& r) { r.required<std::string>("a"); }),
              "case.toml:1: key 'a' has the wrong type (expected text)");
    EXPECT_EQ(refusal([](TableReader& r) { r.table("b").optional<bool>("c"); }),
              "case.toml:4: key 'c' of b has the wrong type (expected true or false)");
    EXPECT_EQ(refusal([](TableReader& r) { r.optional<bool>("a"); }),
              "case.toml:1: key 'a' has the wrong type (expected true or false)");
    EXPECT_EQ(refusal_of("a = nan\n", [](TableReader& r) { r.required<double>("a"); }),
              "case.toml:1: key 'a' is nan (expected a finite number)");
    EXPECT_EQ(refusal_of("a = [1, -inf, 3]", [](TableReader& r) { r.numbers("a", 3); }),
              "case.toml:1: key 'a' is -inf (expected a finite number)");
    for (const char* const list : {"a = [1, 'x', 2, 3]", "a = [true, 2, 3]", "a = [1, 2]"})
        EXPECT_EQ(refusal_of(list, [](TableReader& r) { r.numbers("a", 3); }),
                  "case.toml:1: key 'a' cannot be read (expected 3 numbers in mm)");
    EXPECT_EQ(refusal_of("a = true\n", [](TableReader& r) { r.required<double>("a"); }),
              "case.toml:1: key 'a' has the wrong type (expected a number)");
    EXPECT_EQ(refusal([](TableReader& r) { r.table("a"); }),
              "case.toml:1: key 'a' has the wrong type (expected a table)");
    EXPECT_EQ(refusal([](TableReader& r) { r.list("a"); }),
              "case.toml:1: key 'a' has the wrong type (expected a list)");
    EXPECT_EQ(refusal([](TableReader& r) { r.tables("a"); }),
              "case.toml:1: key 'a' has the wrong type (expected an array of tables, [[a]])");
    EXPECT_EQ(refusal([](TableReader& r) { r.text_or_number("b"); }),
              "case.toml:3: key 'b' has the wrong type (expected text)");
    EXPECT_EQ(refusal([](TableReader& r) { r.table("b").required<double>("c"); }),
              "case.toml:4: key 'c' of b has the wrong type (expected a number)");
    EXPECT_EQ(refusal([](TableReader& r) { r.table("b").table("d").required<double>("e"); }),
              "case.toml: key 'e' of b.d is missing");
}

TEST(TableReader, names_a_number_that_may_not_be) {
    for (const auto& [written, read] : {std::pair("0", "0"), {"-2.5", "-2.5"}})
        EXPECT_EQ(refusal_of("x = 1\nsize_mm = " + std::string(written) + "\n",
                             [](TableReader& r) { r.positive("size_mm"); }),
                  "case.toml:2: key 'size_mm' is " + std::string(read) + " (expected a number above 0)");
    EXPECT_EQ(refusal_of("size_mm = inf", [](TableReader& r) { r.positive("size_mm"); }),
              "case.toml:1: key 'size_mm' is inf (expected a finite number)");
    EXPECT_EQ(refusal_of("[a]\nx = 1\n", [](TableReader& r) { r.table("a").required_positive("size_mm"); }),
              "case.toml:1: key 'size_mm' of a is missing");
}

TEST(TableReader, names_the_line_of_a_list_that_has_not_as_many_numbers) {
    const auto three = [](TableReader& r) { r.numbers("place_mm", 3); };
    for (const char* written : {"[1, 2]", "[1, 2, 3, 4]", "[1, 2, 'x']", "[]", "3"})
        EXPECT_EQ(refusal_of("x = 1\nplace_mm = " + std::string(written) + "\n", three),
                  "case.toml:2: key 'place_mm' cannot be read (expected 3 numbers in mm)")
            << written;
    EXPECT_THAT(refusal_of("x = 1\n", three), ::testing::HasSubstr("key 'place_mm'"));
}

TEST(TableReader, names_what_a_word_may_be_and_which_is_nearest) {
    EXPECT_EQ(refusal_of("kind = 'leever'\n",
                         [](TableReader& r) {
                             r.choice("kind", {"kidney", "liver"});
                         }),
              "case.toml:1: key 'kind' is 'leever' (expected kidney, liver); did you mean liver?");
}

TEST(TableReader, reads_tables_with_their_place) {
    const toml::table table =
        parse_text("[[body]]\nname = 'a'\n[[body]]\nname = 'b'\n[body.mesh]\nsize = 'x'\n", "case.toml", "");
    TableReader reader(table, "case.toml", "");
    auto bodies = reader.tables("body");
    ASSERT_EQ(bodies.size(), 2U);
    EXPECT_EQ(bodies[1].required<std::string>("name"), "b");
    EXPECT_EQ(sample::refusal([&] { bodies[1].table("mesh").required<double>("size"); }),
              "case.toml:6: key 'size' of body.mesh has the wrong type (expected a number)");
    EXPECT_EQ(refusal_of("body = [1]\n", [](TableReader& r) { r.tables("body"); }),
              "case.toml:1: key 'body' has the wrong type (expected an array of tables, [[body]])");
    EXPECT_EQ(reader.list("body").size(), 2U);
}

TEST(TableReader, takes_a_path_as_from_the_folder_of_the_file_in_which_it_stands) {
    const toml::table table =
        parse_text("scan = 'ct.nrrd'\nelsewhere = '/data/ct.nrrd'\n", "cases/one.toml", "");
    TableReader reader(table, "cases/one.toml", "");
    EXPECT_EQ(reader.path("scan"), "cases/ct.nrrd");
    EXPECT_EQ(reader.path("elsewhere"), "/data/ct.nrrd");
}

TEST(TableReader, refuses_a_key_that_nobody_asked_for_with_the_nearest_ones) {
    const auto ask = [](TableReader& r) {
        r.optional<double>("size_mm");
        r.optional<std::string>("name");
        r.refuse_unknown();
    };
    EXPECT_EQ(refusal_of("name = 'a'\nsize_mm = 1\n", ask), "");
    EXPECT_EQ(refusal_of("name = 'a'\nsize_m = 1\n", ask),
              "case.toml:2: key 'size_m' is not known here; did you mean size_mm, name");
    EXPECT_EQ(refusal_of("a = 1\n", [](TableReader& r) { r.refuse_unknown(); }),
              "case.toml:1: key 'a' is not known here");
}

}  // namespace
}  // namespace palpate
