// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/statements.hpp"

#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string>

#include "formats/asset/hdf5/digest.hpp"

namespace palpate::training {
namespace {

using Json = nlohmann::ordered_json;

constexpr auto cmi5 = "https://w3id.org/xapi/cmi5/context/";

// A UUID made from a text: version 8, a rule of one's own (RFC 9562), here its SHA-256.
std::string uuid_of(const std::string& text) {
    const std::string hex = asset::sha256(text);
    return fmt::format("{}-{}-8{}-8{}-{}", hex.substr(0, 8), hex.substr(8, 4), hex.substr(13, 3),
                       hex.substr(17, 3), hex.substr(20, 12));
}

// Letters, digits and '-' of a text: what an address bears without escapes.
std::string slug_of(const std::string& text) {
    std::string slug;
    for (const unsigned char letter : text)
        slug += std::isalnum(letter) != 0 ? static_cast<char>(letter) : '-';
    return slug;
}

Json activity(const std::string& id, const std::string& name, const char* type) {
    return {
        {"objectType", "Activity"},
        {"id", id},
        {"definition",
         {{"name", {{"en", name}}}, {"type", std::string("http://adlnet.gov/expapi/activities/") + type}}}};
}

Json score_json(double score) {
    return {{"scaled", score / 100}, {"raw", score}, {"min", 0}, {"max", 100}};
}

// What all statements of an attempt share.
class Session {
  public:
    Session(const AttemptHead& head, const Attempt& attempt)
        : head_(head),
          case_id_("https://palpate.invalid/case/" + slug_of(head.case_name)),
          object_(activity(case_id_ + "/exercise/" + attempt.exercise().name, attempt.exercise().title,
                           "simulation")),
          id_(uuid_of(head.trainee + head.began + head.when + object_.dump())) {}

    // `result` may be null.
    Json statement(const std::string& verb, const std::string& when, Json result) const {
        Json category = Json::array({{{"id", std::string(cmi5) + "categories/cmi5"}}});
        if (result.contains("success") || result.contains("completion"))
            category.push_back({{"id", std::string(cmi5) + "categories/moveon"}});
        Json made{{"actor",
                   {{"objectType", "Agent"},
                    {"account", {{"homePage", "https://palpate.invalid/trainee"}, {"name", head_.trainee}}}}},
                  {"verb", {{"id", "http://adlnet.gov/expapi/verbs/" + verb}, {"display", {{"en", verb}}}}},
                  {"object", object_},
                  {"context",
                   {{"registration", id_},
                    {"contextActivities",
                     {{"category", category},
                      {"grouping", Json::array({activity(case_id_, head_.case_name, "course")})}}},
                    {"extensions", {{std::string(cmi5) + "extensions/sessionid", id_}}}}},
                  {"timestamp", when}};
        if (!result.is_null()) made["result"] = std::move(result);
        made["id"] = uuid_of(made.dump());
        return made;
    }

  private:
    const AttemptHead& head_;
    std::string case_id_;
    Json object_;
    std::string id_;
};

}  // namespace

std::vector<Json> statements_of(const AttemptHead& head, const Attempt& attempt) {
    const Metrics metrics = attempt.metrics();
    const std::string duration = fmt::format("PT{:.2f}S", metrics.time);
    const Session session(head, attempt);
    std::vector<Json> statements{session.statement("initialized", head.began, nullptr)};
    if (came_to_its_end(attempt.ending())) {
        statements.push_back(
            session.statement("completed", head.when, {{"completion", true}, {"duration", duration}}));
        if (std::isfinite(metrics.score)) {
            const bool passed = reached_all(attempt.ending());
            statements.push_back(session.statement(
                passed ? "passed" : "failed", head.when,
                {{"success", passed}, {"score", score_json(metrics.score)}, {"duration", duration}}));
        }
    }
    statements.push_back(session.statement("terminated", head.when, {{"duration", duration}}));
    return statements;
}

}  // namespace palpate::training
