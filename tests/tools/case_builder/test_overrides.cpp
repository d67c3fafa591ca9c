// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tools/case_builder/case_file.hpp"
#include "tools/case_builder/overrides.hpp"

namespace palpate::case_builder {
namespace {

const std::string text = R"(schema = 1
name = "liver"
[input]
labels = "liver.seg.nrrd"
[[deformable]]
name = "liver"
mesh = { cell_size_mm = 8 }
fixed = [{ touching = "skull" }]
[[deformable.region]]
label = "liver"
youngs_modulus_kpa = 6
poissons_ratio = 0.45
)";

class Overrides : public testing::Test {
  protected:
    void SetUp() override { std::ofstream(folder_ / "case.toml") << text; }

    CaseFile with(const std::string& setting, int line = 7) const {
        const Override override = parse_override(setting, "tables/patients.tsv", line);
        return read_case_file(folder_ / "case.toml", {&override, 1});
    }

    std::string message(const std::string& setting) const try {
        with(setting);
        return "";
    } catch (const Error& error) {
        return error.what();
    }

    sample::Scratch folder_;
};

TEST_F(Overrides, go_before_what_the_case_file_says) {
    EXPECT_EQ(with("haptics.tool_radius_mm=2.5").haptics.tool_radius, 2.5);
    EXPECT_EQ(with("name=left liver").name, "left liver");
    EXPECT_EQ(with("name=7 \"years\"").name, "7 \"years\"");
}

TEST_F(Overrides, call_elements_of_arrays_of_tables_by_their_names_or_labels) {
    EXPECT_EQ(with("deformable.liver.mesh.cell_size_mm=5").deformable.at(0).mesh.sizing.cell_size, 5);
    EXPECT_EQ(with("deformable.liver.region.liver.youngs_modulus_kpa=9")
                  .deformable.at(0)
                  .condense.materials.at(0)
                  .youngs_modulus_kpa,
              9);
}

TEST_F(Overrides, resolve_paths_from_the_file_in_which_they_are_written) {
    EXPECT_EQ(with("input.volume=scans/7.nrrd").volume, "tables/scans/7.nrrd");
    EXPECT_EQ(with("input.volume=scans/7.nrrd").labels, folder_ / "liver.seg.nrrd");
}

TEST_F(Overrides, are_named_by_file_and_line_where_they_are_wrong) {
    EXPECT_NE(message("haptics.tool_radius_mm=wide").find("tables/patients.tsv:7"), std::string::npos);
    EXPECT_NE(message("haptics.tool_radius=3").find("tables/patients.tsv:7"), std::string::npos);
    EXPECT_NE(message("haptics.tool_radius=3").find("did you mean tool_radius_mm"), std::string::npos);
    const std::string nowhere = message("deformable.livre.mesh.cell_size_mm=5");
    EXPECT_NE(nowhere.find("tables/patients.tsv:7"), std::string::npos) << nowhere;
    EXPECT_NE(nowhere.find("nearest names: 'liver'"), std::string::npos) << nowhere;
    EXPECT_NE(message("schema.version=1").find("a table"), std::string::npos);
    EXPECT_NE(message("wide").find("KEY=VALUE"), std::string::npos);
    EXPECT_NE(message("name=\xff").find("tables/patients.tsv:7: key 'name' has a value that is no UTF-8"),
              std::string::npos);
}

}  // namespace
}  // namespace palpate::case_builder
