// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>
#include <map>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tools/case_builder/case_file.hpp"

namespace palpate::case_builder {
namespace {

using namespace case_builder;

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
    static const sample::Scratch folder;  // of each process, as tests run side by side
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
    EXPECT_EQ(body.mesh.sizing.cell_size, 8);
    EXPECT_EQ(body.mesh.regions, (std::vector<std::string>{"liver"}));
    EXPECT_EQ(body.condense.fixed.at(0).touching, "skull");
    EXPECT_EQ(body.condense.fixed.at(1).sphere_mm, (std::vector<double>{1, 2, 3.5, 4}));
    EXPECT_EQ(body.condense.materials.at(0).youngs_modulus_kpa, 6);
}

TEST(CaseFile, how_the_inputs_are_read_becomes_requests_of_import) {
    const auto with = [](const std::string& lines) {
        std::string text = minimal;
        text.insert(text.find("[[structure]]"), lines);
        return read_case_file(written(text));
    };
    const CaseFile file =
        with("series = 3\naccept_gaps = true\ndeface = true\nlabel_names = \"totalsegmentator:v2/total\"\n");
    EXPECT_EQ(file.volume_import.series, "3");
    EXPECT_TRUE(file.volume_import.accept_gaps);
    EXPECT_TRUE(file.volume_import.deface);
    EXPECT_EQ(file.labels_import.label_names, "totalsegmentator:v2/total");
    EXPECT_FALSE(file.labels_import.accept_gaps);
    EXPECT_FALSE(file.label_table);
    EXPECT_EQ(file.volume_import.scale, 1);
    const CaseFile scaled = with("scale = 15.7\noffset = -1024\n");
    EXPECT_EQ(scaled.volume_import.scale, 15.7);
    EXPECT_EQ(scaled.volume_import.offset, -1024);
    EXPECT_THROW(with("scale = -1.0\n"), InvalidInput);
    EXPECT_EQ(with("series = \"portal venous\"\n").volume_import.series, "portal venous");

    const auto table = written(minimal).parent_path() / "names.ctbl";
    std::ofstream(table) << "1 liver\n";
    const CaseFile named =
        with("label_names = \"names.ctbl\"\noverlaps = \"smaller\"\nnifti_frame = \"qform\"\n");
    EXPECT_EQ(named.label_table, table);
    EXPECT_EQ(named.labels_import.label_names, table.string());
    EXPECT_EQ(named.labels_import.overlaps, "smaller");
    EXPECT_EQ(named.labels_import.nifti_frame, "qform");
    EXPECT_EQ(named.volume_import.nifti_frame, "qform");
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

TEST(CaseFile, a_region_may_relax_by_a_series_that_makes_sense) {
    const auto with = [](const std::string& terms) { return minimal + "relaxation = [" + terms + "]\n"; };
    EXPECT_TRUE(read_case_file(written(minimal)).deformable.at(0).condense.relaxation.empty());
    const CaseFile file =
        read_case_file(written(with("{ share = 0.3, time_s = 0.5 }, { share = 0.2, time_s = 4 }")));
    const auto& terms = file.deformable.at(0).condense.relaxation;
    ASSERT_EQ(terms.size(), 2U);
    EXPECT_EQ(terms[1].label, "liver");
    EXPECT_EQ(terms[1].term.share, 0.2);
    EXPECT_EQ(terms[1].term.time, 4);
    for (const auto& [text, part] : std::map<std::string, std::string>{
             {"{ share = 0.3, time = 0.5 }", "time_s"},
             {"{ share = 0.3, time_s = 1, tau = 2 }", "tau"},
             {"{ share = 1.2, time_s = 1 }", "between 0 and 1"},
             {"{ share = 0.6, time_s = 1 }, { share = 0.5, time_s = 2 }", "0.9999 at most"},
             {"{ share = 0.2, time_s = 1e-300 }", "0.001 to 1e+06"},
             {"{ share = 0.2, time_s = 2 }, { share = 0.2, time_s = 1 }", "ascending times"}}) {
        const std::string found = message(with(text));
        EXPECT_NE(found.find("case.toml:17"), std::string::npos) << found;
        EXPECT_NE(found.find(part), std::string::npos) << found;
    }
}

TEST(CaseFile, says_which_bodies_are_deformed_far) {
    std::string whole = minimal;
    EXPECT_FALSE(read_case_file(written(whole)).deformable.at(0).large_deformation);
    whole.insert(whole.find("mesh ="), "large_deformation = true\n");
    EXPECT_TRUE(read_case_file(written(whole)).deformable.at(0).large_deformation);
    whole.replace(whole.find("= true"), 6, "= 1");
    EXPECT_NE(message(whole).find("'large_deformation'"), std::string::npos) << message(whole);
}

TEST(CaseFile, colours_are_of_bodies_and_regions_and_written_as_in_the_web) {
    const CaseFile file = read_case_file(written(minimal + R"(colour = "#c8b8A0"
[[rigid]]
name = "skull"
colour = "#ffffff"
)"));
    ASSERT_EQ(file.deformable.at(0).colours.size(), 1U);
    EXPECT_EQ(file.deformable[0].colours[0].body, "liver");
    EXPECT_EQ(file.deformable[0].colours[0].region, "liver");
    EXPECT_EQ(file.deformable[0].colours[0].colour, (Colour{0xc8, 0xb8, 0xa0}));
    ASSERT_EQ(file.rigid.at(0).colours.size(), 1U);
    EXPECT_EQ(file.rigid[0].colours[0].body, "skull");
    EXPECT_EQ(file.rigid[0].colours[0].region, "");
    std::string whole = minimal;
    whole.insert(whole.find("mesh ="), "colour = \"#7a3a2f\"\n");
    EXPECT_EQ(read_case_file(written(whole)).deformable.at(0).colours.at(0).region, "");
    for (const char* wrong : {"\"red\"", "\"#12345\"", "\"#12345g\"", "7"}) {
        const std::string found = message(minimal + "colour = " + wrong + "\n");
        EXPECT_NE(found.find("case.toml:17"), std::string::npos) << found;
        EXPECT_NE(found.find("'colour'"), std::string::npos) << found;
    }
}

TEST(CaseFile, keeps_the_scan_unless_told_otherwise) {
    EXPECT_TRUE(read_case_file(written(minimal)).keep_scan);
    std::string text = minimal;
    text.insert(text.find("labels ="), "keep_scan = false\n");
    EXPECT_FALSE(read_case_file(written(text)).keep_scan);
}

TEST(CaseFile, a_posture_is_for_all_bodies_and_needs_densities) {
    const auto with = [](const std::string& posture, const std::string& region) {
        return minimal + region + "[posture]\n" + posture;
    };
    const CaseFile file = read_case_file(
        written(with("scanned = \"supine\"\nfelt = [0, -0.5, 0.5]\n", "density_kg_m3 = 1060\n")));
    const stages::CondenseRequest& condense = file.deformable.at(0).condense;
    EXPECT_EQ(condense.scanned_posture, "supine");
    EXPECT_EQ(condense.felt_posture, "0,-0.5,0.5");
    ASSERT_EQ(condense.densities.size(), 1U);
    EXPECT_EQ(condense.densities[0].label, "liver");
    EXPECT_EQ(condense.densities[0].density_kg_m3, 1060);
    EXPECT_TRUE(read_case_file(written(minimal)).deformable.at(0).condense.felt_posture.empty());
    const std::string both = "scanned = \"supine\"\nfelt = \"prone\"\n";
    EXPECT_NE(message(with("scanned = \"supine\"\n", "")).find("'felt'"), std::string::npos);
    EXPECT_NE(message(with(both, "")).find("density_kg_m3"), std::string::npos);
    EXPECT_NE(message(with(both, "density_kg_m3 = -1\n")).find("density_kg_m3"), std::string::npos);
    EXPECT_NE(message(with(both + "sitting = true\n", "density_kg_m3 = 1060\n")).find("sitting"),
              std::string::npos);
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

// The minimal case with more lines in its deformable body.
std::string with_lines(const std::string& lines) {
    std::string text = minimal;
    return text.insert(text.find("[[deformable.region]]"), lines);
}

TEST(CaseFile, nodes_are_held_and_touched_by_the_same_rules) {
    std::string text = minimal;
    const std::string rules =
        "[{ touching = \"background\" }, { region = \"tumour\" }, { box_mm = [0, 0, 0, 1, 2.5, 3] }, "
        "{ sphere_mm = [1, 2, 3, 4] }, { plane_mm = [0, 0, 0, 0, 0, 1] }, "
        "{ facing = [0, 1, 0] }, { nodes_file = \"sets/rim.txt\" }]";
    text.replace(text.find("fixed = "), text.find('\n', text.find("fixed = ")) - text.find("fixed = "),
                 "fixed = " + rules + "\ncontact = " + rules);
    const DeformableSpec body = read_case_file(written(text)).deformable.at(0);
    const auto file = written(text).parent_path() / "sets/rim.txt";
    for (const auto& picks : {body.condense.fixed, body.condense.contact}) {
        ASSERT_EQ(picks.size(), 7U);
        EXPECT_EQ(picks[0].touching, "background");
        EXPECT_EQ(picks[1].region, "tumour");
        EXPECT_EQ(picks[2].box_mm, (std::vector<double>{0, 0, 0, 1, 2.5, 3}));
        EXPECT_EQ(picks[3].sphere_mm, (std::vector<double>{1, 2, 3, 4}));
        EXPECT_EQ(picks[4].plane_mm, (std::vector<double>{0, 0, 0, 0, 0, 1}));
        EXPECT_EQ(picks[5].facing, (std::vector<double>{0, 1, 0}));
        EXPECT_EQ(picks[6].nodes_file, file);
    }
}

TEST(CaseFile, a_rule_that_is_not_understood_is_refused) {
    const auto of_rule = [](const std::string& rule) {
        return message(with_lines("contact = [" + rule + "]\n"));
    };
    EXPECT_NE(of_rule("{ sphere_mm = [1, 2] }").find("4 numbers"), std::string::npos);
    EXPECT_NE(of_rule("{ spere_mm = [1, 2, 3, 4] }").find("did you mean sphere_mm"), std::string::npos);
    EXPECT_NE(of_rule("{ spere_mm = [1, 2, 3, 4] }").find("deformable.contact"), std::string::npos);
    EXPECT_NE(of_rule("{ touching = 3 }").find("wrong type"), std::string::npos);
    EXPECT_NE(of_rule("{ touching = \"a\", region = \"b\" }").find("one of { touching"), std::string::npos);
    EXPECT_NE(of_rule("{ }").find("one of { touching"), std::string::npos);
    EXPECT_NE(message(with_lines("contact = \"skull\"\n")).find("'contact'"), std::string::npos);
}

TEST(CaseFile, element_and_compliance_become_a_request_of_condense) {
    EXPECT_EQ(read_case_file(written(minimal)).deformable.at(0).condense.element, "linear");
    const stages::CondenseRequest request =
        read_case_file(
            written(with_lines("element = \"quadratic\"\ncompliance = { accuracy = 2e-3, size_mib = 50, "
                               "memory_gib = 2.5, representation = \"hierarchical\" }\n")))
            .deformable.at(0)
            .condense;
    EXPECT_EQ(request.element, "quadratic");
    EXPECT_EQ(request.accuracy, 2e-3);
    EXPECT_EQ(request.size_mib, 50);
    EXPECT_EQ(request.memory_gib, 2.5);
    EXPECT_EQ(request.representation, "hierarchical");
}

TEST(CaseFile, wrong_values_of_element_and_compliance_are_refused_with_line_and_what_is_meant) {
    for (const auto& [line, phrase] : std::initializer_list<std::pair<std::string, std::string>>{
             {"element = \"quadratc\"", "did you mean quadratic"},
             {"element = 2", "wrong type"},
             {"elements = \"linear\"", "did you mean element"},
             {"compliance = { accuracy = 0 }", "is 0 (expected a number above 0)"},
             {"compliance = { size_mib = -1 }", "is -1"},
             {"compliance = { memory_gib = nan }", "is nan"},
             {"compliance = { memory_gib = \"2\" }", "wrong type"},
             {"compliance = { memory_gb = 2 }", "did you mean memory_gib"},
             {"compliance = { representation = \"sparse\" }", "(expected auto, dense, hierarchical)"},
             {"compliance = 3", "a table"}}) {
        const std::string text = message(with_lines(line + "\n"));
        EXPECT_NE(text.find(phrase), std::string::npos) << text;
        EXPECT_NE(text.find("case.toml:13"), std::string::npos) << text;
    }
}

TEST(CaseFile, imported_meshes_and_surfaces_need_no_image) {
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
    const stages::MeshRequest& mesh = file.deformable.at(0).mesh;
    EXPECT_EQ(mesh.mesh_file.filename(), "liver.msh");
    EXPECT_EQ(mesh.unit, "cm");
    EXPECT_EQ(mesh.region_names.at(0).mesh_region, 1);
    EXPECT_EQ(file.rigid.at(0).surface.unit, "mm");
    EXPECT_EQ(file.rigid.at(0).surface.frame, "ras");
    EXPECT_TRUE(needs_labels(read_case_file(written(minimal))));
}

TEST(CaseFile, an_imported_file_beside_what_would_make_it_is_refused) {
    const std::string head = "schema = 1\nname = \"x\"\n[[rigid]]\nname = \"y\"\n";
    EXPECT_NE(message(head + "surface_file = \"y.stl\"\nisovalue_hu = 226\n").find("isovalue_hu"),
              std::string::npos);
    EXPECT_NE(message(head + "surface_unit = \"cm\"\n").find("'surface_file'"), std::string::npos);
}

}  // namespace
}  // namespace palpate::case_builder
