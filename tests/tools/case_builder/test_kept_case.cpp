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
seeds_file = "left_lobe_seeds_file.json"

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

TEST_F(KeptCase, is_not_in_what_is_no_asset) {
    std::ofstream(folder_ / "x.vtkhdf") << "x";
    EXPECT_THROW(read_case_file(folder_ / "x.vtkhdf"), InvalidInput);
}

}  // namespace
}  // namespace palpate::case_builder
