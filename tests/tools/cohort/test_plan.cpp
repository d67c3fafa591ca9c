// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tools/cohort/plan.hpp"

namespace palpate::cohort {
namespace {

using Kind = StageState::Kind;

// Labels to two meshes to an asset to a report.
PatientBuild two_meshes() {
    PatientBuild build;
    build.patient = {"anna", true, "/c.toml", {{"haptics.tool_radius_mm", "2", "/t.tsv", 2}}, "/t.tsv:2", ""};
    build.paths = {"/o/anna.parts", "/o/anna.vtkhdf", "/o/anna.html"};
    build.stages = {{"import labels", "import", {}, {"/l"}, {"/o/labels"}},
                    {"mesh a", "mesh", {}, {"/o/labels"}, {"/o/a"}},
                    {"mesh b", "mesh", {}, {"/o/labels"}, {"/o/b"}},
                    {"pack", "pack", {}, {"/o/a", "/o/b"}, {"/o/anna.vtkhdf"}},
                    {"report", "report", {}, {"/o/anna.vtkhdf"}, {"/o/anna.html"}}};
    return build;
}

StageState state(Kind kind, int exit_code = 0) {
    StageState state{kind, {}, {}};
    if (kind == Kind::finished) state.record.emplace();
    if (kind == Kind::failed) state.failure = {exit_code, "said"};
    return state;
}

TEST(Plan, a_stage_comes_after_all_that_it_reads_and_a_report_after_everything) {
    const PatientBuild build = two_meshes();
    EXPECT_EQ(stages_before(build, 0), std::vector<std::size_t>{});
    EXPECT_EQ(stages_before(build, 2), std::vector<std::size_t>{0});
    EXPECT_EQ(stages_before(build, 3), (std::vector<std::size_t>{1, 2}));
    EXPECT_EQ(stages_before(build, 4).size(), 4U);
}

TEST(Plan, has_what_is_not_finished_and_nothing_that_bad_input_keeps_from_running) {
    const PatientBuild build = two_meshes();
    const StageState finished = state(Kind::finished), waiting = state(Kind::waiting);
    // Bad input (3) would fail again; what a signal ended (137) may not.
    EXPECT_EQ(stages_to_do(build, {finished, state(Kind::failed, 3), state(Kind::to_do), waiting, waiting}),
              (std::vector<bool>{false, false, true, false, false}));
    EXPECT_EQ(stages_to_do(build, {finished, state(Kind::failed, 137), finished, waiting, waiting}),
              (std::vector<bool>{false, true, false, true, true}));
    EXPECT_EQ(stages_to_do(build, std::vector<StageState>(5, finished)), std::vector<bool>(5, false));

    const std::vector<PatientBuild> builds{build, build};
    const std::vector<std::vector<StageState>> states{
        {finished, finished, state(Kind::to_do), waiting, waiting}, std::vector<StageState>(5, finished)};
    const auto plan =
        plan_of(std::span(builds).first(1), std::span(states).first(1), {"/o"}, "/tables", "/bin");
    const auto& patient = plan.at("patients").at("anna");
    EXPECT_EQ(patient.at("request"), "/o/.batch/requests/anna.json");
    ASSERT_EQ(patient.at("stages").size(), 3U);
    EXPECT_EQ(patient.at("stages").at("mesh-b").at("stage"), "mesh b");
    EXPECT_EQ(patient.at("stages").at("mesh-b").at("after"), nlohmann::json::array());
    EXPECT_EQ(patient.at("stages").at("pack").at("after"), nlohmann::json({"mesh-b"}));
    EXPECT_TRUE(plan_of(std::span(builds).last(1), std::span(states).last(1), {"/o"}, "/tables", "/bin")
                    .at("patients")
                    .empty());
}

TEST(Plan, a_request_is_what_the_row_says) {
    EXPECT_EQ(request_of(two_meshes()), nlohmann::ordered_json({{"case", "/c.toml"},
                                                                {"output", "/o/anna.vtkhdf"},
                                                                {"virtual_clock", true},
                                                                {"set", {"haptics.tool_radius_mm=2"}}}));
}

}  // namespace
}  // namespace palpate::cohort
