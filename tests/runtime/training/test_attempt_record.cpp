// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "runtime/training/attempt_record.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/runtime/training/attempt_head.hpp"

namespace palpate {
namespace {

using namespace training;

class AttemptRecord : public ::testing::Test {
  protected:
    Attempt attempt(Ending ending) const {
        Attempt made(
            {.name = "touch",
             .title = "Touch the marks",
             .instruction = "",
             .task = Task::touch,
             .time_limit = 10,
             .least_force = 0.1,
             .most_force = 1,
             .tolerance = 2,
             .hold = 0.05,
             .places = {case_.deformable_bodies[0].boundary.surface.vertices[0], Eigen::Vector3d(99, 0, 0)},
             .region = ""},
            case_);
        TickResult tick{};
        tick.force = {0, 0.5, 0};
        tick.contact_count = 1;
        tick.contacts[0] = {.body = 1, .vertices = {0, -1, -1}, .weights = {1, 0, 0}, .force = 1};
        for (int i = 0; i < 200; ++i) {
            tick.time = i * 0.001;
            made.add(tick);
        }
        made.end(ending);
        return made;
    }
    const Case case_ = sample::sample_case();
    sample::Scratch scratch_;
};

TEST_F(AttemptRecord, a_pseudonym_names_files_and_nothing_else) {
    for (const char* good : {"T-07", "anna_2", "x"}) EXPECT_TRUE(is_pseudonym(good)) << good;
    for (const std::string& bad : {std::string(), std::string("../x"), std::string("a b"),
                                   std::string(41, 'a'), std::string("\xc3\xa9")})
        EXPECT_FALSE(is_pseudonym(bad)) << bad;
}

TEST_F(AttemptRecord, json_has_every_metric_and_null_for_what_is_not_defined) {
    const auto json = attempt_json(sample::attempt_head("2026-03-01T09:30:00Z"), attempt(Ending::ended));
    EXPECT_EQ(json["schema"], "palpate.attempt/1");
    EXPECT_EQ(json["ending"], "ended");
    EXPECT_EQ(json["metrics"].size(), std::tuple_size_v<decltype(metric_fields)>);
    EXPECT_DOUBLE_EQ(json["metrics"]["score"], 50);
    EXPECT_DOUBLE_EQ(json["metrics"]["peak_force_n"], 0.5);
    EXPECT_TRUE(json["metrics"]["tremor_mm"].is_null());  // too short
    EXPECT_EQ(json["exercise"]["places_mm"].size(), 2U);
}

TEST_F(AttemptRecord, csv_has_a_row_every_hundredth_of_a_second) {
    const std::string csv = attempt_csv(attempt(Ending::ended));
    EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + 20);
    EXPECT_THAT(csv, ::testing::StartsWith("time_s,x_mm,y_mm,z_mm,force_n,depth_mm\n0.010,"));
}

TEST_F(AttemptRecord, history_is_by_time_and_leaves_out_what_does_not_belong) {
    const auto write = [&](const std::string& name, const nlohmann::ordered_json& json) {
        std::ofstream(scratch_ / name) << json.dump();
    };
    write("b.json", attempt_json(sample::attempt_head("2026-03-02T09:30:00Z"), attempt(Ending::time_is_up)));
    write("a.json", attempt_json(sample::attempt_head("2026-03-01T09:30:00Z"), attempt(Ending::ended)));
    write("c.json", attempt_json(sample::attempt_head("2026-03-03T09:30:00Z"), attempt(Ending::cut_short)));
    auto other = attempt_json(sample::attempt_head("2026-03-04T09:30:00Z"), attempt(Ending::ended));
    other["case"] = "another";
    write("d.json", other);
    std::ofstream(scratch_ / "e.json") << "{ not json";
    write("f.json", {{"schema", "palpate.attempt/1"}, {"metrics", 3}});
    std::ofstream(scratch_ / "g.csv") << "time_s\n";
    std::ofstream(scratch_ / "h.json")
        << attempt_json(sample::attempt_head("2026-03-05T09:30:00Z"), attempt(Ending::ended)).dump()
        << std::string(std::size_t{1} << 20, ' ');
    std::filesystem::create_symlink("/dev/zero", scratch_ / "i.json");
    std::vector<std::string> told;
    const auto history = read_history(scratch_ / "", "liver 3", "touch",
                                      [&](const std::string& sentence) { told.push_back(sentence); });
    ASSERT_EQ(history.size(), 2U);
    EXPECT_EQ(history[0].when, "2026-03-01T09:30:00Z");
    EXPECT_DOUBLE_EQ(history[1].score, 50);
    EXPECT_EQ(told.size(), 4U);
    EXPECT_TRUE(read_history(scratch_ / "none", "x", "y", {}).empty());
}

}  // namespace
}  // namespace palpate
