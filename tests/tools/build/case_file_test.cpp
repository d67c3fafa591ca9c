// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/build/case_file.hpp"

#include <fstream>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"

namespace palpate::build {
namespace {

const std::string minimal = R"(schema = 1
name = "liver"
[input]
labels = "liver.seg.nrrd"
[[structure]]
name = "tumour"
recipe = "sphere"
center_mm = [1, 2.5, 3]
[[deformable]]
name = "liver"
mesh = { cell_size_mm = 8 }
fixed = [{ touching = "skull" }, { sphere_mm = [1, 2, 3.5, 4] }]
[[deformable.region]]
label = "liver"
youngs_modulus_kpa = 6
poissons_ratio = 0.45
)";

std::filesystem::path written(const std::string& text) {
    const auto path = std::filesystem::path(testing::TempDir()) / "case.toml";
    std::ofstream(path) << text;
    return path;
}

std::string message(const std::string& text) {
    try {
        read_case_file(written(text));
        return "";
    } catch (const InvalidInput& error) {
        return error.what();
    }
}

TEST(CaseFile, reads_what_people_write) {
    const CaseFile file = read_case_file(written(minimal));
    EXPECT_EQ(file.name, "liver");
    EXPECT_EQ(file.labels->filename(), "liver.seg.nrrd");
    EXPECT_FALSE(file.volume);
    EXPECT_EQ(file.structures.at(0).parameters.at("center_mm"), nlohmann::ordered_json::parse("[1, 2.5, 3]"));
    const DeformableSpec& body = file.deformable.at(0);
    EXPECT_EQ(body.sizing.at("--cell-size"), 8);
    EXPECT_EQ(body.fixed, (std::vector<std::string>{"touching:skull", "sphere:1,2,3.5,4"}));
    EXPECT_EQ(body.regions.at(0).youngs_modulus_kpa, 6);
}

TEST(CaseFile, files_that_recipes_read_lie_beside_it_and_parameters_keep_their_order) {
    const CaseFile file = read_case_file(written(minimal + R"([[structure]]
name = "liver"
recipe = "liver"
seeds_file = "seeds/liver.mrk.json"
open_mm = 2
keep_largest = true
close_mm = 1
scribbles = "strokes.seg.nrrd"
)"));
    const StructureSpec& liver = file.structures.at(1);
    const auto folder = std::filesystem::path(testing::TempDir());
    EXPECT_EQ(liver.files.at("seeds_file"), folder / "seeds/liver.mrk.json");
    EXPECT_EQ(liver.files.at("scribbles"), folder / "strokes.seg.nrrd");
    EXPECT_EQ(liver.parameters.dump(), R"({"open_mm":2,"keep_largest":true,"close_mm":1})");
}

TEST(CaseFile, an_unknown_key_is_refused_with_line_and_nearest_name) {
    const std::string text = message(minimal + "poisons_ratio = 0.4\n");
    EXPECT_NE(text.find("case.toml:17"), std::string::npos) << text;
    EXPECT_NE(text.find("did you mean poissons_ratio"), std::string::npos) << text;
}

TEST(CaseFile, a_missing_key_is_named) {
    EXPECT_NE(message("schema = 1\n").find("'name'"), std::string::npos);
    EXPECT_NE(message("name = \"x\"\n").find("'schema'"), std::string::npos);
}

TEST(CaseFile, a_newer_schema_asks_for_a_newer_palpate) {
    EXPECT_NE(message("schema = 2\nname = \"x\"\n").find("newer palpate"), std::string::npos);
}

TEST(CaseFile, wrong_types_and_syntax_errors_name_the_line) {
    EXPECT_NE(message("schema = 1\nname = 3\n").find("case.toml:2"), std::string::npos);
    EXPECT_NE(message("schema = 1\nname = \n").find("case.toml:2"), std::string::npos);
}

TEST(CaseFile, a_case_without_bodies_or_regions_is_refused) {
    EXPECT_NE(message("schema = 1\nname = \"x\"\n").find("body"), std::string::npos);
    EXPECT_NE(message("schema = 1\nname = \"x\"\n[[deformable]]\nname = \"y\"\n").find("region"),
              std::string::npos);
}

TEST(CaseFile, a_fixed_rule_with_too_few_numbers_is_refused) {
    EXPECT_NE(
        message("schema = 1\nname = \"x\"\n[[deformable]]\nname = \"y\"\nfixed = [{ sphere_mm = [1, 2] }]\n")
            .find("4 numbers"),
        std::string::npos);
}

}  // namespace
}  // namespace palpate::build
