// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>
#include <gmock/gmock.h>
#include <sstream>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/tools/refusal_of.hpp"
#include "tools/cohort/bids/bids_folder.hpp"
#include "tools/cohort/bids/bids_name.hpp"
#include "tools/cohort/bids/bids_table.hpp"
#include "tools/cohort/patient_table.hpp"

namespace palpate::cohort {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(BidsName, is_taken_apart_and_spelled_as_it_was) {
    const auto name = parse_bids_name("sub-01_ses-02_acq-a_run-2_T1w.nii.gz");
    ASSERT_TRUE(name);
    EXPECT_EQ(name->suffix, "T1w");
    EXPECT_EQ(name->extension, ".nii.gz");
    EXPECT_EQ((*name)["run"], "2");
    EXPECT_EQ((*name)["echo"], "");
    EXPECT_EQ(spelled(*name), "sub-01_ses-02_acq-a_run-2_T1w.nii.gz");
    EXPECT_TRUE(name->has_all_of(*parse_bids_name("run-2_acq-a", false)));
    EXPECT_FALSE(name->has_all_of(*parse_bids_name("run-1", false)));
    for (const char* other : {"", "T1w.nii.gz", "sub-01.nii.gz", "sub-_T1w.nii", "-01_T1w.nii",
                              "scan_sub-01_T1w.nii", "sub-01__T1w.nii", "sub-01_"})
        EXPECT_FALSE(parse_bids_name(other)) << other;
    EXPECT_TRUE(parse_bids_name("dseg.tsv", false));
}

// A dataset of empty files: no image is read.
class BidsTable : public testing::Test {
  protected:
    const sample::Scratch scratch_;
    const fs::path folder_ = fs::canonical(scratch_.path());
    const fs::path dataset_ = folder_ / "bids", out_ = folder_ / "out", case_ = folder_ / "case.toml";
    std::string notes_;

    void SetUp() override {
        fs::create_directories(dataset_);
        std::ofstream(dataset_ / "dataset_description.json") << R"({"Name": "x", "BIDSVersion": "1.9.0"})";
        write_case("threshold");
    }

    // Recipe "import" takes a label map, "threshold" does not.
    void write_case(const std::string& recipe) const {
        std::ofstream(case_) << "schema = 1\nname = \"x\"\n[[structure]]\nname = \"liver\"\nrecipe = \""
                             << recipe << "\"\n[[rigid]]\nname = \"liver\"\n";
    }
    void add(const std::string& file, const std::string& text = "") const {
        fs::create_directories((dataset_ / file).parent_path());
        std::ofstream(dataset_ / file) << text;
    }
    std::vector<Patient> patients(const BidsChoice& choice = {}) {
        notes_.clear();
        std::istringstream stream(
            bids_patient_table(dataset_, case_, out_, choice,
                               [&](std::string_view said) { notes_ += std::string(said) + "\n"; }));
        return parse_patient_table(stream, out_ / "patients.tsv");
    }
    std::string refusal(const BidsChoice& choice = {}) {
        return test::refusal_of<Error>([&] { patients(choice); });
    }
};

std::vector<std::string> names_in(const std::vector<Patient>& patients) {
    std::vector<std::string> names;
    for (const Patient& patient : patients) names.push_back(patient.name);
    return names;
}

BidsChoice image(const std::string& name) {
    BidsChoice choice;
    choice.image = name;
    return choice;
}
BidsChoice segmentation(const std::string& name) {
    BidsChoice choice;
    choice.segmentation = name;
    return choice;
}
BidsChoice derivatives(const fs::path& folder) {
    BidsChoice choice;
    choice.derivatives = folder;
    return choice;
}

// "key=value" of each override, without quotes and the way to the dataset.
std::vector<std::string> settings_of(const Patient& patient) {
    std::vector<std::string> settings;
    for (const auto& override : patient.overrides) {
        std::string value = override.value;
        std::erase(value, '"');
        if (value.starts_with("../bids/")) value.erase(0, 8);
        settings.push_back(override.key + "=" + value);
    }
    return settings;
}

TEST_F(BidsTable, subjects_and_sessions_become_rows_in_the_order_of_their_names) {
    add("sub-10/anat/sub-10_T1w.nii.gz");
    add("sub-02/ses-b/anat/sub-02_ses-b_T1w.nii");
    add("sub-02/ses-a/anat/sub-02_ses-a_T1w.nii.gz");
    add("sub-02/ses-c/func/sub-02_ses-c_task-rest_bold.nii.gz");
    add("sub-10/anat/sub-10_T1w.json");
    add("sub-10/anat/sub-11_T1w.nii.gz");
    add("sourcedata/sub-12/anat/sub-12_T1w.nii.gz");
    const auto rows = patients();
    EXPECT_THAT(names_in(rows), ElementsAre("sub-02_ses-a", "sub-02_ses-b", "sub-10"));
    EXPECT_THAT(notes_, HasSubstr("another session has: sub-02_ses-c"));
    for (const Patient& row : rows) {
        EXPECT_EQ(row.mistake, "");
        EXPECT_EQ(row.case_path, case_);
    }
    EXPECT_THAT(settings_of(rows[1]), ElementsAre("input.volume=sub-02/ses-b/anat/sub-02_ses-b_T1w.nii"));
}

TEST_F(BidsTable, one_kind_of_image_is_taken_of_all_and_what_a_subject_lacks_is_his_problem_alone) {
    add("sub-01/anat/sub-01_T1w.nii.gz");
    add("sub-01/anat/sub-01_T2w.nii.gz");
    add("sub-02/anat/sub-02_T1w.nii.gz");
    add("sub-03/anat/sub-03_T2w.nii.gz");
    add("sub-04/anat/sub-04_T1w.json");
    fs::create_directories(dataset_ / "sub-05" / "ses-1");
    add("sub-05/ses-2/anat/sub-05_ses-2_PDw.nii.gz");
    fs::create_directories(dataset_ / "sub-06" / "anat");
    fs::create_symlink("../../.git/annex/objects/none", dataset_ / "sub-06/anat/sub-06_T1w.nii.gz");
    auto rows = patients();
    EXPECT_THAT(names_in(rows), ElementsAre("sub-01", "sub-02", "sub-03", "sub-04", "sub-05", "sub-06"));
    EXPECT_THAT(notes_, HasSubstr("the T1w images are taken; there are T2w, PDw too"));
    EXPECT_EQ(rows[0].mistake + rows[1].mistake, "");
    EXPECT_THAT(rows[2].mistake, HasSubstr("patients.tsv:4: has no T1w image; there are sub-03_T2w.nii.gz"));
    EXPECT_THAT(rows[3].mistake, HasSubstr("has no image in anat/ or ct/"));
    EXPECT_THAT(rows[4].mistake, HasSubstr("has no T1w image; there are sub-05_ses-2_PDw.nii.gz"));
    EXPECT_THAT(rows[5].mistake, HasSubstr("sub-06_T1w.nii.gz is a link to a file that is not there"));
    for (const Patient& row : rows) EXPECT_TRUE(row.named);
    rows = patients(image("T2w"));
    EXPECT_EQ(rows[0].mistake + rows[2].mistake, "");
    EXPECT_THAT(rows[1].mistake, HasSubstr("has no T2w image"));
    EXPECT_THAT(refusal(image("FLAIR")), HasSubstr("sub-01 has no FLAIR image"));
    EXPECT_THAT(refusal(image("T2w.nii")), HasSubstr("--image: 'T2w.nii'"));
}

TEST_F(BidsTable, a_subject_counts_once_however_often_he_was_scanned) {
    add("sub-01/ses-1/anat/sub-01_ses-1_T1w.nii.gz");
    add("sub-01/ses-2/anat/sub-01_ses-2_T1w.nii.gz");
    add("sub-01/ses-3/anat/sub-01_ses-3_T1w.nii.gz");
    add("sub-02/anat/sub-02_FLAIR.nii.gz");
    add("sub-03/anat/sub-03_FLAIR.nii.gz");
    patients();
    EXPECT_THAT(notes_, HasSubstr("the FLAIR images are taken; there are T1w too"));
}

TEST_F(BidsTable, of_runs_the_first_is_taken_and_acquisitions_are_named) {
    add("sub-01/anat/sub-01_run-10_T1w.nii.gz");
    add("sub-01/anat/sub-01_run-02_T1w.nii.gz");
    add("sub-01/anat/sub-01_space-MNI152_T1w.nii.gz");
    add("sub-02/anat/sub-02_acq-b_T1w.nii.gz");
    add("sub-02/anat/sub-02_acq-a_T1w.nii.gz");
    auto rows = patients();
    EXPECT_THAT(settings_of(rows[0]), ElementsAre("input.volume=sub-01/anat/sub-01_run-02_T1w.nii.gz"));
    EXPECT_THAT(notes_, HasSubstr("the first is taken, of 1 patients"));
    EXPECT_THAT(rows[1].mistake,
                HasSubstr("has 2 T1w images, sub-02_acq-a_T1w.nii.gz, sub-02_acq-b_T1w.nii.gz"));
    EXPECT_TRUE(settings_of(rows[1]).empty());
    rows = patients(image("acq-b"));
    EXPECT_THAT(settings_of(rows[1]), ElementsAre("input.volume=sub-02/anat/sub-02_acq-b_T1w.nii.gz"));
    rows = patients(image("space-MNI152_T1w"));
    EXPECT_THAT(settings_of(rows[0]), ElementsAre("input.volume=sub-01/anat/sub-01_space-MNI152_T1w.nii.gz"));
}

TEST_F(BidsTable, segmentations_are_found_where_the_case_takes_them_with_the_nearest_names) {
    add("sub-01/anat/sub-01_acq-a_T1w.nii.gz");
    add("sub-02/ses-1/anat/sub-02_ses-1_T1w.nii.gz");
    add("derivatives/x/dseg.tsv");
    add("derivatives/x/desc-other_dseg.tsv");
    add("derivatives/x/sub-01/anat/sub-01_acq-a_dseg.nii.gz");
    add("derivatives/x/sub-01/anat/sub-01_acq-b_dseg.nii.gz");
    add("derivatives/x/sub-01/anat/sub-01_space-MNI152_dseg.nii.gz");
    add("derivatives/x/sub-02/ses-1/anat/sub-02_ses-1_space-orig_dseg.nii.gz");
    add("derivatives/x/sub-02/ses-1/sub-02_ses-1_dseg.tsv");
    add("derivatives/palpate/dataset_description.json", R"({"GeneratedBy": [{"Name": "Palpate"}]})");
    add("derivatives/palpate/sub-01/anat/sub-01_acq-a_desc-palpate_dseg.nii.gz");
    EXPECT_THAT(settings_of(patients()[0]), ElementsAre("input.volume=sub-01/anat/sub-01_acq-a_T1w.nii.gz"));
    write_case("import");
    auto rows = patients();
    EXPECT_EQ(rows[0].mistake + rows[1].mistake, "");
    EXPECT_THAT(settings_of(rows[0]),
                ElementsAre("input.volume=sub-01/anat/sub-01_acq-a_T1w.nii.gz",
                            "input.labels=derivatives/x/sub-01/anat/sub-01_acq-a_dseg.nii.gz",
                            "input.label_names=derivatives/x/dseg.tsv"));
    EXPECT_EQ(settings_of(rows[1])[2], "input.label_names=derivatives/x/sub-02/ses-1/sub-02_ses-1_dseg.tsv");

    add("derivatives/y/sub-01/anat/sub-01_acq-a_seg-organs_dseg.nii.gz");
    EXPECT_THAT(
        patients()[0].mistake,
        HasSubstr("has 2 segmentations, x/sub-01_acq-a_dseg.nii.gz, y/sub-01_acq-a_seg-organs_dseg.nii.gz"));
    EXPECT_EQ(settings_of(patients(derivatives(dataset_ / "derivatives" / "y"))[0])[1],
              "input.labels=derivatives/y/sub-01/anat/sub-01_acq-a_seg-organs_dseg.nii.gz");
    rows = patients(segmentation("seg-organs"));
    EXPECT_EQ(rows[0].mistake, "");
    EXPECT_THAT(rows[1].mistake, HasSubstr("has no segmentation sub-02_ses-1_dseg.nii.gz"));
    EXPECT_THAT(refusal(derivatives(folder_ / "none")), HasSubstr("is no folder"));
    EXPECT_THAT(refusal(segmentation("organs_mask")), HasSubstr("--segmentation: 'organs_mask'"));
}

TEST_F(BidsTable, names_of_labels_that_are_open_or_not_there_are_the_rows_problem) {
    write_case("import");
    for (const std::string subject : {"sub-01", "sub-02", "sub-03"}) {
        add(subject + "/anat/" + subject + "_T1w.nii.gz");
        add("derivatives/x/" + subject + "/anat/" + subject + "_seg-a_desc-b_dseg.nii.gz");
    }
    add("derivatives/x/sub-01/seg-a_dseg.tsv");
    add("derivatives/x/sub-01/desc-b_dseg.tsv");
    fs::create_symlink("../none", dataset_ / "derivatives/x/sub-02/dseg.tsv");
    add("derivatives/x/dseg.tsv");
    const auto rows = patients();
    EXPECT_THAT(rows[0].mistake, HasSubstr("has 2 tables of label names that are as near as each other, "
                                           "desc-b_dseg.tsv and seg-a_dseg.tsv; keep one"));
    EXPECT_THAT(rows[1].mistake, HasSubstr("dseg.tsv is a link to a file that is not there"));
    EXPECT_EQ(rows[2].mistake, "");
}

TEST_F(BidsTable, a_folder_that_cannot_be_read_is_not_taken_for_an_empty_one) {
    add("sub-01/anat/sub-01_T1w.nii.gz");
    add("sub-02/notes.txt");
    fs::create_symlink("anat", dataset_ / "sub-02/anat");  // refused to root too
    EXPECT_THAT(refusal(), HasSubstr("sub-02/anat: could not be read: "));
}

TEST_F(BidsTable, a_dataset_that_another_program_made_too_is_not_ours) {
    const auto made_by = [](const char* makers) { return is_ours(nlohmann::json::parse(makers)); };
    EXPECT_TRUE(made_by(R"({"GeneratedBy": [{"Name": "Palpate"}]})"));
    for (const char* makers :
         {R"({"GeneratedBy": [{"Name": "Palpate"}, {"Name": "x"}]})", R"({"GeneratedBy": ["Palpate"]})",
          R"({"GeneratedBy": [{"Name": 1}]})", R"({"GeneratedBy": []})", "{}"})
        EXPECT_FALSE(made_by(makers)) << makers;
}

TEST_F(BidsTable, what_is_no_dataset_is_refused) {
    EXPECT_THAT(refusal(), HasSubstr("has no subjects"));
    add("sub-01/anat/sub-01_T1w.nii.gz");
    add("dataset_description.json", "[]");
    EXPECT_THAT(refusal(), HasSubstr("is no JSON object"));
    fs::remove(dataset_ / "dataset_description.json");
    EXPECT_THAT(refusal(), HasSubstr("has no dataset_description.json"));
}

}  // namespace
}  // namespace palpate::cohort
