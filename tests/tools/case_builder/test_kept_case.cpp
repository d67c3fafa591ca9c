// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tools/case_builder/case_file.hpp"
#include "tools/case_builder/kept_case.hpp"

namespace palpate::case_builder {
namespace {

const std::string as_written = R"(schema = 1   # of John Doe
name = "liver"
[input]
volume = "doe_john.nii.gz"
labels = 'doe "j".seg.nrrd'
series = "1.2.840.113619.2"
label_names = "totalsegmentator"
[[structure]]
name = "left lobe"
recipe = "grow-from-seeds"
smooth_mm = 2
open_mm = 0.1
seeds_file = "doe/clicked.mrk.json"
[[deformable]]
name = "liver"
mesh_file = "doe.msh"
fixed = [{ touching = "skull" }, { nodes_file = "doe.txt" }]
[[deformable.region]]
label = "liver"
tissue = "liver"
[haptics]
tool_radius_mm = 4.0
)";

const std::string kept = R"(schema = 1
name = 'liver'

[input]
volume = "volume.nii.gz"
labels = "labels.seg.nrrd"
label_names = 'totalsegmentator'

[[structure]]
name = 'left lobe'
recipe = 'grow-from-seeds'
smooth_mm = 2
open_mm = 0.1
seeds_file = "structure_1_seeds_file.json"

[[deformable]]
name = 'liver'
mesh_file = "liver_mesh_file.msh"
fixed = [{ touching = 'skull' }, { nodes_file = "liver_fixed_2_nodes_file.txt" }]

[[deformable.region]]
label = 'liver'
tissue = 'liver'

[haptics]
tool_radius_mm = 4.0
)";

class KeptCase : public testing::Test {
  protected:
    std::string of(const std::string& document, std::span<const Override> overrides = {}) const {
        std::ofstream(folder_ / "case.toml") << document;
        return read_case_file(folder_ / "case.toml", overrides).kept;
    }

    sample::Scratch folder_;
};

TEST_F(KeptCase, says_what_the_case_says_in_its_order_but_nothing_of_the_patients) {
    EXPECT_EQ(of(as_written), kept);
    EXPECT_EQ(of(kept), kept);
}

TEST_F(KeptCase, has_what_goes_before_the_case_file) {
    const std::vector<Override> overrides{parse_override("input.labels=/patients/doe.nii", "--set", 1),
                                          parse_override("input.series=3", "--set", 2),
                                          parse_override("quality.attempts=2", "--set", 3)};
    const std::string with = of(as_written, overrides);
    EXPECT_NE(with.find("labels = \"labels.nii\"\nseries = 3\n"), std::string::npos) << with;
    EXPECT_TRUE(with.ends_with("\n[quality]\nattempts = 2\n")) << with;
    EXPECT_EQ(of(with), with);
}

TEST_F(KeptCase, knows_a_table_of_label_names_from_a_scheme) {
    std::ofstream(folder_ / "totalsegmentator") << "1 liver\n";
    EXPECT_NE(of(as_written).find("label_names = \"label_names\"\n"), std::string::npos);
}

TEST_F(KeptCase, keeps_numbers_as_numbers_and_texts_as_texts) {
    std::string numbers = as_written;
    numbers.insert(numbers.find("tool_radius_mm"), "max_force_n = 1e-5\n");
    numbers.replace(numbers.find("name = \"liver\""), 14, R"(name = "it's \"x\" \\ \u00e9")");
    for (const char* number : {"1e-5", "1e20", "-0.0", "100.0", "0.1"}) {
        std::string text = numbers;
        text.replace(text.find("0.1\n"), 3, number);
        const std::string once = of(text);
        EXPECT_EQ(of(once), once) << once;
        const auto read = read_case_file(folder_ / "case.toml").structures.at(0).parameters["open_mm"];
        EXPECT_TRUE(read.is_number_float());
        EXPECT_EQ(read, std::stod(number));
    }
}

TEST_F(KeptCase, leaves_a_series_out_of_inline_tables_too) {
    std::string text = as_written;
    const std::size_t begin = text.find("[input]"), end = text.find("[[structure]]");
    text.replace(begin, end - begin, "input = { volume = \"ct\", series = \"1.2.840.113619.2\" }\n");
    EXPECT_NE(of(text).find("input = { volume = \"input_volume\" }\n"), std::string::npos) << of(text);
}

TEST_F(KeptCase, calls_files_apart_whose_structures_names_differ_in_letters_that_no_file_has) {
    std::string text = as_written;
    text += "[[structure]]\nname = \"left_lobe\"\nrecipe = \"organ\"\nseeds_file = \"b.Smith\"\n";
    EXPECT_NE(of(text).find("seeds_file = \"structure_1_seeds_file.json\""), std::string::npos) << of(text);
    EXPECT_NE(of(text).find("seeds_file = \"left_lobe_seeds_file\""), std::string::npos) << of(text);
}

TEST_F(KeptCase, is_not_in_what_is_no_asset) {
    std::ofstream(folder_ / "x.vtkhdf") << "x";
    EXPECT_THROW(read_case_file(folder_ / "x.vtkhdf"), InvalidInput);
}

}  // namespace
}  // namespace palpate::case_builder
