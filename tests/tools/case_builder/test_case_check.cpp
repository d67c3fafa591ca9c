// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tools/case_builder/checks/case_check.hpp"

namespace palpate::case_builder {
namespace {

// Lines 1 to 33 of a case without mistakes.
const std::string sound_case = R"(schema = 1
name = "liver"
[input]
volume = "ct.nrrd"
[[structure]]
name = "skull"
recipe = "bone"
[[structure]]
name = "liver"
recipe = "liver"
seeds_mm = [1, 2, 3]
[[structure]]
name = "tumour"
recipe = "sphere"
inside = "liver"
center_mm = [1, 2.5, 3]
radius_mm = 4
[[rigid]]
name = "skull"
isovalue_hu = 226
[[deformable]]
name = "liver"
mesh = { cell_size_mm = 8 }
refine = [{ near = "tumour", within_mm = 10, cell_size_mm = 3 }]
fixed = [{ touching = "skull" }, { box_mm = [0, 0, 0, 1, 2, 3] }]
[[deformable.region]]
label = "liver"
youngs_modulus_kpa = 6
poissons_ratio = 0.45
[[deformable.region]]
label = "Tumour"
youngs_modulus_kpa = 30
poissons_ratio = 0.45
)";

// The case with one text in place of another.
std::string with(const std::string& text, const std::string& in_its_place) {
    std::string changed = sound_case;
    const auto found = changed.find(text);
    EXPECT_NE(found, std::string::npos) << text;
    return changed.replace(found, text.size(), in_its_place);
}

std::string mistakes_of(const std::string& text) {
    const sample::Scratch scratch;
    std::ofstream(scratch / "ct.nrrd") << "a volume";
    mkfifo((scratch / "pipe").c_str(), 0600);
    std::ofstream(scratch / "case.toml") << text;
    try {
        check_case_file(scratch / "case.toml", read_case_file(scratch / "case.toml"));
        return "";
    } catch (const InvalidInput& error) {
        return error.what();
    }
}

TEST(CaseCheck, a_sound_case_passes) {
    EXPECT_EQ(mistakes_of(sound_case), "");
}

TEST(CaseCheck, a_mistake_is_told_by_line_before_anything_is_built) {
    struct Mistake {
        const char* text;
        const char* in_its_place;
        const char* line;
        const char* phrase;
    };
    for (const auto& [text, in_its_place, line, phrase] : std::vector<Mistake>{
             {"\"bone\"", "\"bones\"", ":7:", "nearest names: 'bone'"},
             {"seeds_mm = [1, 2, 3]\n", "", ":10:", "needs seeds"},
             {"seeds_mm = [1, 2, 3]", "seeds_mm = [1, 2]", ":11:", "x, y, z"},
             {"seeds_mm = [1, 2, 3]", "seeds_file = \"l.mrk.json\"", ":11:", "l.mrk.json"},
             {"seeds_mm = [1, 2, 3]", "seeds_mm = [1, 2, 3]\nneck = 3", ":12:", "neck_mm"},
             {"inside = \"liver\"", "inside = \"livr\"", ":15:", "nearest names: 'liver'"},
             {"inside = \"liver\"", "inside = \"tumour\"", ":15:", "no structure before it"},
             {"center_mm = [1, 2.5, 3]", "center_mm = [1, 2.5, inf]", ":16:", "finite"},
             {"radius_mm = 4", "radius_mm = -4", ":17:", "0 or more"},
             {"name = \"tumour\"", "name = \"liver\"", ":13:", "a second time"},
             {"name = \"tumour\"", "name = \"left/tumour\"", ":13:", "is 'left/tumour' (expected no '/'"},
             {"name = \"tumour\"", "name = 'left\\tumour'", ":13:", "is 'left\\tumour'"},
             {"[[rigid]]\nname = \"skull\"", "[[rigid]]\nname = \"scull\"", ":19:", "'skull'"},
             {"cell_size_mm = 8", "cell_size_mm = 0", ":23:", "above 0"},
             {"near = \"tumour\"", "near = \"tumor\"", ":24:", "'tumour'"},
             {"within_mm = 10", "within_mm = -1", ":24:", "above 0"},
             {"touching = \"skull\"", "touching = \"bone\"", ":25:", "names 'bone'"},
             {"[0, 0, 0, 1, 2, 3]", "[0, 0, 4, 1, 2, 3]", ":25:", "first corner"},
             {"{ touching = \"skull\" }", "{ nodes_file = \"rim.txt\" }", ":25:", "rim.txt"},
             {"fixed = [{ touching = \"skull\" }, { box_mm = [0, 0, 0, 1, 2, 3] }]\n", "",
              ":21:", "'fixed' of deformable is missing"},
             {"label = \"liver\"\nyoung", "label = \"lever\"\nyoung", ":27:", "'liver'"},
             {"youngs_modulus_kpa = 6\n", "youngs_modulus_kpa = -6\n", ":28:", "expected 0.001 to 2e+09"},
             {"poissons_ratio = 0.45", "poissons_ratio = 0.5", ":29:", "between -1 and 0.5"},
             {"volume = \"ct.nrrd\"", "volume = \"mr.nrrd\"", "mr.nrrd", "is not there"},
             {"volume = \"ct.nrrd\"", "volume = \"\"", ":4:", "'volume' of input is empty"},
             {"{ touching = \"skull\" }", "{ nodes_file = \"\" }",
              ":25:", "'nodes_file' of deformable.fixed is empty"},
             {"[0, 0, 0, 1, 2, 3]", "[0, 0, 0, 1, 2, inf]", ":25:", "is inf (expected a finite number)"},
             {"cell_size_mm = 8 }", "cell_size_mm = 8, smoothing_mm = nan }",
              ":23:", "'smoothing_mm' of deformable.mesh is nan"},
             {"cell_size_mm = 8 }", "cell_size_mm = 8, facet_distance_mm = -1 }", ":23:", "0 or more"},
             {"refine =", "compliance = { accuracy = 1 }\nrefine =", ":24:", "is 1 (expected 0.0001 to 0.1)"},
             {"name = \"liver\"", "name = \"\"", ":2:", "has 0 bytes (expected 1 to 255)"},
             {"name = \"liver\"", "name = \"a\\u0000b\"", ":2:", "'name' holds a control character"},
             {"\"ct.nrrd\"", "\"ct.nrrd\\u0000\"", ":4:", "'volume' holds a control character"},
             // Nobody is to wait for their end.
             {"volume = \"ct.nrrd\"", "volume = \"/dev/zero\"", "/dev/zero",
              "is a device (expected a file or a folder"},
             {"volume = \"ct.nrrd\"", "volume = \"ct.nrrd\"\nlabels = \"pipe\"", "pipe",
              "is a pipe (expected a file)"},
             {"volume = \"ct.nrrd\"", "volume = \"ct.nrrd\"\nlabels = \".\"", "",
              "is a folder (expected a file)"},
             {"{ touching = \"skull\" }", "{ nodes_file = \"pipe\" }", ":25:", "is a pipe (expected a file)"},
             {"{ touching = \"skull\" }", "{ nodes_file = \"/dev/zero\" }", ":25:", "is a device"},
             {"seeds_mm = [1, 2, 3]", "seeds_file = \"/\"", ":11:", "is a folder"},
         }) {
        const std::string found = mistakes_of(with(text, in_its_place));
        EXPECT_NE(found.find(line), std::string::npos) << in_its_place << "\n" << found;
        EXPECT_NE(found.find(phrase), std::string::npos) << in_its_place << "\n" << found;
    }
}

TEST(CaseCheck, what_recipes_and_bodies_look_at_must_be_named) {
    const std::string found = mistakes_of(with("volume = \"ct.nrrd\"\n", ""));
    EXPECT_NE(found.find("has 3 mistakes"), std::string::npos) << found;
    EXPECT_NE(found.find("'bone', which needs grey values"), std::string::npos) << found;
    EXPECT_NE(found.find("'liver', which needs grey values"), std::string::npos) << found;
    EXPECT_NE(found.find("isovalue_hu"), std::string::npos) << found;
    EXPECT_NE(mistakes_of(with("recipe = \"bone\"", "recipe = \"import\"")).find("needs a label map"),
              std::string::npos);
}

TEST(CaseCheck, numbers_of_tool_and_contract_stay_in_range) {
    EXPECT_NE(mistakes_of(sound_case + "[haptics]\ntool_radius_mm = 0\n").find(":35:"), std::string::npos);
    EXPECT_NE(mistakes_of(sound_case + "[quality]\nmin_dice = 1.5\n").find("0 to 1"), std::string::npos);
    for (const char* attempts : {"0", "101"}) {
        const std::string found = mistakes_of(sound_case + "[quality]\nattempts = " + attempts + "\n");
        EXPECT_NE(found.find(":35:"), std::string::npos) << found;
        EXPECT_NE(found.find("(expected 1 to 100)"), std::string::npos) << found;
    }
}

TEST(CaseCheck, a_posture_is_one_of_five_or_a_direction) {
    for (const auto& [felt, phrase] : {std::pair("\"nix\"", "(expected supine, prone, left_side"),
                                       {"[0, 0, 0]", "has no length"},
                                       {"[nan, 0, 0]", "is nan"}}) {
        const std::string found =
            mistakes_of(sound_case + "[posture]\nscanned = \"supine\"\nfelt = " + felt + "\n");
        EXPECT_NE(found.find(":36:"), std::string::npos) << found;
        EXPECT_NE(found.find(phrase), std::string::npos) << found;
    }
}

TEST(CaseCheck, names_fit_into_files_and_assets) {
    const std::string found =
        mistakes_of(with("name = \"liver\"", "name = \"" + std::string(4000, 'n') + "\""));
    EXPECT_NE(found.find(":2: key 'name' has 4000 bytes (expected 1 to 255)"), std::string::npos) << found;
    const std::string body = mistakes_of(
        with("[[rigid]]\nname = \"skull\"", "[[rigid]]\nname = \"" + std::string(300, 's') + "\""));
    EXPECT_NE(body.find(":19: "), std::string::npos) << body;
    EXPECT_NE(body.find("200 at most"), std::string::npos) << body;
}

}  // namespace
}  // namespace palpate::case_builder
