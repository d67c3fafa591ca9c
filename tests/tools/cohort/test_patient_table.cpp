// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>
#include <gmock/gmock.h>

#include "tests/formats/scratch.hpp"
#include "tests/tools/refusal_of.hpp"
#include "tools/cohort/patient_table.hpp"

namespace palpate::cohort {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

class PatientTable : public testing::Test {
  protected:
    const sample::Scratch folder_;
    const fs::path table_ = folder_ / "patients.tsv";

    std::vector<Patient> read(const std::string& text) const {
        std::ofstream(table_) << text;
        return read_patient_table(table_);
    }
    std::string refusal(const std::string& text) const {
        return test::refusal_of([&] { read(text); });
    }
};

TEST_F(PatientTable, rows_name_case_files_and_values_that_go_before_theirs) {
    const auto patients = read(
        "\xEF\xBB\xBFpatient\tcase\tvolume\thaptics.tool_radius_mm\t#note\r\n"
        "anna\tcases/liver.toml\tct \"a\".nrrd\t2\tsecond visit\r\n"
        "\r\n"
        "b.2\t/cases/liver.toml\t\t\t\r\n");
    ASSERT_EQ(patients.size(), 2U);
    EXPECT_EQ(patients[0].name, "anna");
    EXPECT_EQ(patients[0].case_path, folder_ / "cases" / "liver.toml");
    EXPECT_TRUE(patients[0].named);
    EXPECT_EQ(patients[0].mistake, "");
    ASSERT_EQ(patients[0].overrides.size(), 2U);
    EXPECT_EQ(patients[0].overrides[0].key, "input.volume");
    EXPECT_EQ(patients[0].overrides[0].value, R"("ct \"a\".nrrd")");
    EXPECT_EQ(patients[0].overrides[0].file, table_);
    EXPECT_EQ(patients[0].overrides[1].key, "haptics.tool_radius_mm");
    EXPECT_EQ(patients[0].overrides[1].value, "2");
    EXPECT_EQ(patients[1].case_path, "/cases/liver.toml");
    EXPECT_EQ(patients[1].where, table_.string() + ":4");
    EXPECT_TRUE(patients[1].overrides.empty());
}

TEST_F(PatientTable, what_is_no_utf8_is_refused_with_row_and_column_but_in_notes) {
    EXPECT_THAT(refusal("patient\tcase\tvolume\na\tc.toml\tx\xff\n"),
                HasSubstr("patients.tsv:2: column 'volume' is no UTF-8; save the table as UTF-8"));
    EXPECT_THAT(refusal("patient\tcase\nb\tc.toml\na\xe9\tc.toml\n"),
                HasSubstr("patients.tsv:3: column 'patient' is no UTF-8"));
    EXPECT_THAT(refusal("patient\tcase\nb\tc.toml\t\xe9\n"), HasSubstr(":2: column 3 is no UTF-8"));
    EXPECT_THAT(refusal("patient\tcase\tgr\xfc\n"), HasSubstr(":1: column 3 is no UTF-8"));
    EXPECT_EQ(read("patient\tcase\t#note\nb\tc.toml\tgr\xfc\n").at(0).mistake, "");
}

TEST_F(PatientTable, a_row_that_cannot_be_used_keeps_its_mistake_and_the_others_stay) {
    const auto patients = read(
        "patient\tcase\n"
        "p 1;touch X\tc.toml\n"
        "../up\tc.toml\n"
        "index\tc.toml\n"
        "good\tc.toml\n"
        "good\tc.toml\n"
        "empty\t\n"
        "long\tc.toml\tmore\n");
    const std::vector<std::string> mistakes{
        "no safe file name",          "no safe file name",      "cohort's own page", "",
        "stands in the table before", "column 'case' is empty", "has 3 cells"};
    ASSERT_EQ(patients.size(), mistakes.size());
    for (std::size_t i = 0; i < mistakes.size(); ++i) {
        EXPECT_THAT(patients[i].mistake, HasSubstr(mistakes[i]));
        if (!mistakes[i].empty()) {
            EXPECT_THAT(patients[i].mistake, StartsWith(patients[i].where + ": "));
        }
        EXPECT_EQ(patients[i].named, i == 3 || i > 4) << i;
    }
}

TEST_F(PatientTable, a_row_with_a_problem_is_not_built_and_names_of_labels_are_text) {
    const auto patients = read(
        "patient\tcase\tlabel_names\tproblem\n"
        "a\tc.toml\t../bids/dseg.tsv\t\n"
        "b\t\t\thas two images\n"
        "../c\tc.toml\t\thas no image\n");
    ASSERT_EQ(patients.size(), 3U);
    EXPECT_EQ(patients[0].mistake, "");
    ASSERT_EQ(patients[0].overrides.size(), 1U);
    EXPECT_EQ(patients[0].overrides[0].key, "input.label_names");
    EXPECT_EQ(patients[0].overrides[0].value, R"("../bids/dseg.tsv")");
    EXPECT_EQ(patients[1].mistake, patients[1].where + ": has two images");
    EXPECT_TRUE(patients[1].named);
    EXPECT_THAT(patients[2].mistake, HasSubstr("no safe file name"));
    EXPECT_FALSE(patients[2].named);
}

TEST_F(PatientTable, a_head_that_cannot_be_used_is_refused_by_its_column) {
    EXPECT_THAT(
        refusal("patient\tcase\tvolumes\np\tc.toml\t\n"),
        AllOf(HasSubstr("patients.tsv:1"), HasSubstr("'volumes'"), HasSubstr("nearest names: 'volume'")));
    EXPECT_THAT(refusal("patient\tvolume\np\tct.nrrd\n"), HasSubstr("has no column 'case'"));
    EXPECT_THAT(refusal("patient,case\np,c.toml\n"), HasSubstr("'patient,case'"));
    EXPECT_THAT(refusal("patient\tcase\tcase\np\tc.toml\tc.toml\n"), HasSubstr("'case' twice"));
    EXPECT_THAT(refusal("patient\tcase\n"), HasSubstr("has no patients"));
    EXPECT_THAT(refusal(""), HasSubstr("has no patients"));
}

}  // namespace
}  // namespace palpate::cohort
