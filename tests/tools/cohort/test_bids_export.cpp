// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>
#include <gmock/gmock.h>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/tools/refusal_of.hpp"
#include "tools/cohort/bids/bids_export.hpp"

namespace palpate::cohort {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Patients that count as built, for they have no stages, of a dataset without files.
class BidsExportTest : public testing::Test {
  protected:
    const sample::Scratch scratch_;
    const fs::path folder_ = fs::canonical(scratch_.path());
    const fs::path dataset_ = folder_ / "bids", staged_ = folder_ / "staged";
    Cohort cohort_{folder_ / "patients.tsv", {folder_ / "out"}, {}};

    void SetUp() override {
        fs::create_directories(dataset_);
        fs::create_directories(staged_);
        std::ofstream(dataset_ / "dataset_description.json") << R"({"Name": "x", "BIDSVersion": "1.9.0"})";
    }

    void add(const std::string& name, const std::string& image) {
        PatientBuild& build = cohort_.builds.emplace_back();
        build.patient.name = name;
        build.patient.where = "patients.tsv:" + std::to_string(cohort_.builds.size() + 1);
        if (!image.empty()) build.case_file.volume = dataset_ / image;
        build.paths.asset = folder_ / (name + ".vtkhdf");
        build.paths.report = folder_ / (name + ".html");
        std::ofstream(build.paths.asset) << name;
        std::ofstream(build.paths.report) << name;
    }
    void write(const fs::path& output) const {
        write_bids_dataset(cohort_, States(cohort_.builds.size()), output, staged_, [](double) {});
    }
    // Of an export that must leave nothing.
    std::string refusal(const fs::path& output) const {
        const std::string said = test::refusal_of([&] { write(output); });
        return fs::is_empty(staged_) ? said : "something was written";
    }
};

TEST_F(BidsExportTest, names_lead_to_subject_and_session_wherever_the_image_lies) {
    add("sub-01", "sub-01/sub-01_T1w.nii.gz");
    add("sub-02_ses-a", "sub-02/ses-a/ct/sub-02_ses-a_ct.nii.gz");
    add("sub-03", "sub-03/anat/sub-03_acq-x_desc-y_T1w.nii.gz");
    write(folder_ / "made");
    for (const char* file : {"sub-01/anat/sub-01_desc-palpate_asset.vtkhdf",
                             "sub-03/anat/sub-03_acq-x_desc-palpate_asset.vtkhdf",
                             "sub-02/ses-a/anat/sub-02_ses-a_desc-palpate_report.html"})
        EXPECT_TRUE(fs::exists(staged_ / file)) << file;
}

TEST_F(BidsExportTest, patients_whose_files_would_have_the_same_names_are_refused) {
    add("sub-01_a", "sub-01/anat/sub-01_T1w.nii.gz");
    add("sub-01_b", "sub-01/anat/sub-01_T2w.nii.gz");
    EXPECT_THAT(refusal(folder_ / "made"),
                HasSubstr("patients.tsv:3: 'sub-01_a' and 'sub-01_b' would both be "
                          "sub-01/anat/sub-01_desc-palpate"));
}

TEST_F(BidsExportTest, a_patient_without_image_is_refused_by_name) {
    add("sub-01", "");
    EXPECT_THAT(refusal(folder_ / "made"), HasSubstr("patients.tsv:2: 'sub-01' was built without an image"));
}

TEST_F(BidsExportTest, what_it_is_made_of_does_not_lie_in_the_output) {
    add("sub-01", "sub-01/anat/sub-01_T1w.nii.gz");
    EXPECT_THAT(refusal(folder_), HasSubstr("has " + dataset_.string() + " in it"));
    EXPECT_THAT(refusal(dataset_), HasSubstr("in it, of which it would be made"));
    EXPECT_THROW(require_outside(folder_, cohort_.folder.root), InvalidInput);
    EXPECT_NO_THROW(require_outside(dataset_ / "derivatives", dataset_));
}

}  // namespace
}  // namespace palpate::cohort
