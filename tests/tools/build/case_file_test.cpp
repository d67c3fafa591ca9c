// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/build/case_file.hpp"

#include <fstream>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/tools/imaging/hand_written_images.hpp"

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
    static const palpate::testing::TemporaryFolder folder;  // of each process, as tests run side by side
    const auto path = folder / "case.toml";
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

TEST(CaseFile, how_the_inputs_are_read_becomes_options_of_import) {
    using Texts = std::vector<std::string>;
    const auto with = [](const std::string& lines) {
        std::string text = minimal;
        text.insert(text.find("[[structure]]"), lines);
        return read_case_file(written(text));
    };
    const CaseFile file =
        with("series = 3\naccept_gaps = true\nlabel_names = \"totalsegmentator:v2/total\"\n");
    EXPECT_EQ(file.volume_options, (Texts{"--series", "3", "--accept-gaps"}));
    EXPECT_EQ(file.labels_options, (Texts{"--label-names", "totalsegmentator:v2/total"}));
    EXPECT_FALSE(file.label_table);
    EXPECT_EQ(with("series = \"portal venous\"\n").volume_options, (Texts{"--series", "portal venous"}));

    const auto table = written(minimal).parent_path() / "names.ctbl";
    std::ofstream(table) << "1 liver\n";
    const CaseFile named =
        with("label_names = \"names.ctbl\"\noverlaps = \"smaller\"\nnifti_frame = \"qform\"\n");
    EXPECT_EQ(named.label_table, table);
    EXPECT_EQ(named.labels_options,
              (Texts{"--nifti-frame", "qform", "--label-names", table.string(), "--overlaps", "smaller"}));
    EXPECT_THROW(with("accept_gaps = \"yes\"\n"), InvalidInput);
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
    const auto folder = written(minimal).parent_path();
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

TEST(CaseFile, finished_meshes_and_surfaces_need_no_image) {
    const CaseFile file = read_case_file(written(R"(schema = 1
name = "sofa"
[[deformable]]
name = "liver"
mesh_file = "liver.msh"
mesh_unit = "cm"
[[deformable.region]]
label = "liver"
mesh_region = 1
youngs_modulus_kpa = 6
poissons_ratio = 0.45
[[rigid]]
name = "skull"
surface_file = "skull.stl"
surface_frame = "ras"
)"));
    EXPECT_FALSE(needs_labels(file));
    EXPECT_EQ(file.deformable.at(0).file->path.filename(), "liver.msh");
    EXPECT_EQ(file.deformable.at(0).file->unit, "cm");
    EXPECT_EQ(file.deformable.at(0).regions.at(0).mesh_region, 1);
    EXPECT_EQ(file.rigid.at(0).file->unit, "mm");
    EXPECT_EQ(file.rigid.at(0).file->frame, "ras");
    EXPECT_TRUE(needs_labels(read_case_file(written(minimal))));
}

TEST(CaseFile, a_finished_file_beside_what_would_make_it_is_refused) {
    const std::string head = "schema = 1\nname = \"x\"\n[[rigid]]\nname = \"y\"\n";
    EXPECT_NE(message(head + "surface_file = \"y.stl\"\nisovalue_hu = 226\n").find("isovalue_hu"),
              std::string::npos);
    EXPECT_NE(message(head + "surface_unit = \"cm\"\n").find("'surface_file'"), std::string::npos);
}

}  // namespace
}  // namespace palpate::build
