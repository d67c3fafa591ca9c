// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tools/cohort/cohort_page.hpp"
#include "tools/cohort/results.hpp"

namespace palpate::cohort {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::ordered_json;

PatientBuild patient(const std::string& name, const std::string& mistake = "") {
    PatientBuild build;
    build.patient.name = name;
    build.patient.mistake = mistake;
    if (mistake.empty())
        build.stages = {
            {"mesh a", "mesh", {}, {}, {}}, {"mesh b", "mesh", {}, {}, {}}, {"pack", "pack", {}, {}, {}}};
    return build;
}

StageState finished(double seconds, const Json& result) {
    StageState state;
    state.kind = StageState::Kind::finished;
    state.record = case_builder::StageRecord{"", false, seconds, 50'000'000, result};
    return state;
}

std::vector<StageState> all_finished() {
    const auto mesh = [](double volume, double angle) {
        return Json{{"regions", {{{"volume_mm3", volume}}}}, {"tetrahedra", 10}, {"min_dihedral_deg", angle}};
    };
    return {finished(1, mesh(2000, 12)), finished(2, mesh(500, 20)), finished(4, {{"bytes", 3'000'000}})};
}

std::vector<StageState> second_failed() {
    auto states = all_finished();
    states[1] = {StageState::Kind::failed,
                 {},
                 case_builder::StageFailure{4, "palpate-mesh: <too> thin\nchoose\tless\n"}};
    states[2] = {StageState::Kind::waiting, {}, {}};
    return states;
}

TEST(Results, figures_are_of_all_bodies) {
    const PatientResult result = result_of(patient("anna"), all_finished());
    EXPECT_EQ(result.outcome, Outcome::built);
    const Json figures = status_json(result).at("figures");
    EXPECT_EQ(figures, Json({{"volume_ml", 2.5},
                             {"tetrahedra", 20.0},
                             {"min_dihedral_deg", 12.0},
                             {"asset_mb", 3.0},
                             {"seconds", 7.0},
                             {"peak_memory_mb", 50.0}}));
}

TEST(Results, say_how_many_regions_can_be_felt_and_how_faint_the_faintest_is) {
    auto states = all_finished();
    states[2] = finished(4, {{"bytes", 3'000'000},
                             {"felt",
                              {{{"verdict", "felt"}, {"contrast_percent", 41.5}},
                               {{"verdict", "too faint"}, {"contrast_percent", -7.5}}}}});
    const PatientResult result = result_of(patient("anna"), states);
    const Json figures = status_json(result).at("figures");
    EXPECT_EQ(figures.at("felt_regions"), 1);
    EXPECT_EQ(figures.at("contrast_percent"), 7.5);
    EXPECT_THAT(cohort_page("cohort", std::vector{result}), HasSubstr("Contrast of the faintest region"));
}

TEST(Results, a_patient_that_failed_says_where_and_why) {
    const PatientResult failed = result_of(patient("bert"), second_failed());
    const Json json = status_json(failed);
    EXPECT_EQ(json.at("status"), "failed");
    EXPECT_EQ(json.at("failed_stage"), "mesh b");
    EXPECT_EQ(json.at("stages").at(1).at("exit_code"), 4);
    EXPECT_EQ(json.at("stages").at(2).at("status"), "waiting");
    const std::vector<PatientResult> results{failed, result_of(patient("carl", "t.tsv:3: no case"), {}),
                                             result_of(patient("dora"), std::vector<StageState>(3))};
    EXPECT_EQ(results[2].outcome, Outcome::unfinished);
    EXPECT_EQ(summary_text(results),
              "bert  failed at mesh b: palpate-mesh: <too> thin choose less\n"
              "carl  failed: t.tsv:3: no case\n"
              "dora  unfinished\n"
              "0 of 3 patients built, 2 failed, 1 unfinished\n");
    // A line for each patient, whatever was said.
    EXPECT_EQ(std::ranges::count(results_table(results), '\n'), 4);
    const std::string page = cohort_page("cohort", results);
    EXPECT_THAT(page, HasSubstr("palpate-mesh: &lt;too&gt; thin"));
    EXPECT_THAT(page, Not(HasSubstr("<too>")));
}

TEST(Outliers, stand_apart_from_five_or_more) {
    using Values = std::vector<std::optional<double>>;
    EXPECT_EQ(outliers(Values{1.0, 1.1, 0.9, 1.05, 9.0, std::nullopt}),
              (std::vector<bool>{false, false, false, false, true, false}));
    EXPECT_EQ(outliers(Values{1.0, 1.1, 0.9, 9.0}), std::vector<bool>(4, false));
    EXPECT_EQ(outliers(Values{1.0, 1.0, 1.0, 1.0, 9.0}), std::vector<bool>(5, false))
        << "no spread to measure by";
    // Half of a robust standard deviation on either side of the limit: MAD is 1.
    EXPECT_FALSE(outliers(Values{-1.0, 0.0, 1.0, -1.0, 5.1})[4]);
    EXPECT_TRUE(outliers(Values{-1.0, 0.0, 1.0, -1.0, 5.3})[4]);
}

}  // namespace
}  // namespace palpate::cohort
