// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "runtime/training/statements.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/training/attempt_head.hpp"

namespace palpate {
namespace {

using namespace training;
using Json = nlohmann::ordered_json;
using ::testing::ElementsAre;

class Statements : public ::testing::Test {
  protected:
    Attempt attempt(Ending ending, Task task = Task::touch) const {
        Attempt made({.name = "one",
                      .title = "Touch the marks",
                      .instruction = "",
                      .task = task,
                      .most_force = 1,
                      .places = {Eigen::Vector3d::Zero(), Eigen::Vector3d(99, 0, 0)},
                      .region = ""},
                     case_);
        TickResult tick{};
        for (int i = 0; i < 200; ++i) {
            tick.time = i * 0.001;
            made.add(tick);
        }
        made.end(ending);
        return made;
    }
    static std::vector<std::string> verbs(const std::vector<Json>& statements) {
        std::vector<std::string> names;
        for (const Json& statement : statements) {
            const std::string id = statement["verb"]["id"];
            EXPECT_THAT(id, ::testing::StartsWith("http://adlnet.gov/expapi/verbs/"));
            names.push_back(id.substr(id.rfind('/') + 1));
        }
        return names;
    }
    const Case case_ = sample::sample_case();
    const std::string end_ = "2026-03-01T09:30:00Z";
};

TEST_F(Statements, tell_how_an_attempt_ended) {
    const auto told = [&](Ending ending, Task task = Task::touch) {
        return verbs(statements_of(sample::attempt_head(end_), attempt(ending, task)));
    };
    EXPECT_THAT(told(Ending::all_reached), ElementsAre("initialized", "completed", "passed", "terminated"));
    EXPECT_THAT(told(Ending::found), ElementsAre("initialized", "completed", "passed", "terminated"));
    EXPECT_THAT(told(Ending::not_found), ElementsAre("initialized", "completed", "failed", "terminated"));
    EXPECT_THAT(told(Ending::time_is_up), ElementsAre("initialized", "completed", "failed", "terminated"));
    EXPECT_THAT(told(Ending::ended), ElementsAre("initialized", "terminated"));
    EXPECT_THAT(told(Ending::cut_short), ElementsAre("initialized", "terminated"));
    EXPECT_THAT(told(Ending::time_is_up, Task::free), ElementsAre("initialized", "completed", "terminated"));
}

// xAPI 1.0.3, part two; cmi5's statement templates: what every statement has, and where results are and are
// not.
TEST_F(Statements, follow_xapi_and_cmi5) {
    const std::regex uuid("[0-9a-f]{8}-[0-9a-f]{4}-[1-8][0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}");
    const std::string cmi5 = "https://w3id.org/xapi/cmi5/context/";
    std::set<std::string> ids;
    for (const Json& s : statements_of(sample::attempt_head(end_), attempt(Ending::not_found))) {
        const std::string verb = s["verb"]["display"]["en"];
        EXPECT_TRUE(std::regex_match(s["id"].get<std::string>(), uuid)) << s["id"];
        EXPECT_TRUE(ids.insert(s["id"]).second) << "twice";
        EXPECT_EQ(s["actor"]["account"]["name"], "T-07");
        EXPECT_EQ(s["object"]["id"], "https://palpate.invalid/case/liver-3/exercise/one");
        EXPECT_EQ(s["timestamp"], verb == "initialized" ? "2026-03-01T09:29:00Z" : "2026-03-01T09:30:00Z");
        const Json& context = s["context"];
        EXPECT_TRUE(std::regex_match(context["registration"].get<std::string>(), uuid));
        EXPECT_EQ(context["extensions"][cmi5 + "extensions/sessionid"], context["registration"]);
        EXPECT_EQ(context["contextActivities"]["grouping"][0]["id"], "https://palpate.invalid/case/liver-3");
        const Json& category = context["contextActivities"]["category"];
        EXPECT_EQ(category[0]["id"], cmi5 + "categories/cmi5");
        const bool moves_on = verb == "completed" || verb == "failed";
        ASSERT_EQ(category.size(), moves_on ? 2U : 1U) << verb;
        EXPECT_TRUE(!moves_on || category[1]["id"] == cmi5 + "categories/moveon");
        EXPECT_EQ(s.contains("result"), verb != "initialized");
        if (verb == "initialized") continue;
        const Json& result = s["result"];
        EXPECT_EQ(result["duration"], "PT0.20S");
        EXPECT_EQ(result.contains("completion"), verb == "completed");
        EXPECT_EQ(result.contains("success"), verb == "failed");
        EXPECT_EQ(result.contains("score"), verb == "failed");
        EXPECT_FALSE(result.value("success", false));
    }
}

TEST_F(Statements, are_the_same_of_the_same_attempt_alone) {
    EXPECT_EQ(statements_of(sample::attempt_head(end_), attempt(Ending::ended)),
              statements_of(sample::attempt_head(end_), attempt(Ending::ended)));
    EXPECT_NE(statements_of(sample::attempt_head("2026-03-01T09:31:00Z"), attempt(Ending::ended))[0]["id"],
              statements_of(sample::attempt_head(end_), attempt(Ending::ended))[0]["id"]);
}

}  // namespace
}  // namespace palpate
