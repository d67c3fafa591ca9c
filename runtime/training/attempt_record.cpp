// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/attempt_record.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/asset/hdf5/digest.hpp"
#include "formats/model/reading/small_file.hpp"

namespace palpate::training {
namespace {

using Json = nlohmann::ordered_json;

constexpr auto schema = "palpate.attempt/1";

Json number_or_null(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json places_json(const std::vector<Eigen::Vector3d>& places) {
    Json json = Json::array();
    for (const Eigen::Vector3d& p : places) json.push_back({p[0], p[1], p[2]});
    return json;
}

Json exercise_json(const Exercise& exercise) {
    return {{"name", exercise.name},
            {"title", exercise.title},
            {"task", name_of(exercise.task)},
            {"time_limit_s", exercise.time_limit},
            {"least_force_n", exercise.least_force},
            {"most_force_n", exercise.most_force},
            {"tolerance_mm", exercise.tolerance},
            {"hold_s", exercise.hold},
            {"region", exercise.region},
            {"places_mm", places_json(exercise.places)},
            {"outline_mm", places_json(exercise.outline)}};
}

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

std::string verb_of(Ending ending) {
    switch (ending) {
        case Ending::all_reached:
        case Ending::time_is_up:
            return "completed";
        case Ending::ended:
            return "terminated";
        case Ending::not_yet:
        case Ending::cut_short:
            break;
    }
    return "suspended";
}

}  // namespace

bool is_pseudonym(const std::string& text) {
    return !text.empty() && text.size() <= 40 && std::ranges::all_of(text, [](unsigned char letter) {
        return letter < 128 && (std::isalnum(letter) != 0 || letter == '-' || letter == '_');
    });
}

Json attempt_json(const AttemptHead& head, const Attempt& attempt) {
    const Metrics metrics = attempt.metrics();
    Json measured = Json::object();
    for_each_field(metric_fields, [&](const auto& field) {
        measured[key_of(field)] = number_or_null(metrics.*field.member);
    });
    return {{"schema", schema},
            {"trainee", head.trainee},
            {"when", head.when},
            {"case", head.case_name},
            {"device", head.device},
            {"scheme", head.scheme},
            {"version", head.version},
            {"exercise", exercise_json(attempt.exercise())},
            {"ending", words_of(attempt.ending())},
            {"border_mm", places_json(attempt.goals().border)},
            {"metrics", measured}};
}

std::string attempt_csv(const Attempt& attempt) {
    std::string text = "time_s,x_mm,y_mm,z_mm,force_n,depth_mm\n";
    for (const Sample& s : attempt.samples())
        text += fmt::format("{:.3f},{:.4f},{:.4f},{:.4f},{:.5f},{:.4f}\n", s.time, s.position[0],
                            s.position[1], s.position[2], s.force, s.depth);
    return text;
}

Json xapi_statement(const AttemptHead& head, const Attempt& attempt) {
    const Metrics metrics = attempt.metrics();
    const Exercise& exercise = attempt.exercise();
    const std::string verb = verb_of(attempt.ending());
    const bool completed = verb == "completed";
    Json result{{"completion", completed}, {"duration", fmt::format("PT{:.2f}S", metrics.time)}};
    if (std::isfinite(metrics.score))
        result["score"] = {{"scaled", metrics.score / 100}, {"raw", metrics.score}, {"min", 0}, {"max", 100}};
    Json statement{
        {"actor",
         {{"objectType", "Agent"},
          {"account", {{"homePage", "https://palpate.invalid/trainee"}, {"name", head.trainee}}}}},
        {"verb", {{"id", "http://adlnet.gov/expapi/verbs/" + verb}, {"display", {{"en", verb}}}}},
        {"object",
         {{"objectType", "Activity"},
          {"id", "https://palpate.invalid/case/" + slug_of(head.case_name) + "/exercise/" + exercise.name},
          {"definition",
           {{"name", {{"en", exercise.title}}},
            {"type", "http://adlnet.gov/expapi/activities/simulation"}}}}},
        {"result", result},
        {"timestamp", head.when}};
    statement["id"] = uuid_of(statement.dump());
    return statement;
}

std::vector<PastAttempt> read_history(const std::filesystem::path& folder, const std::string& case_name,
                                      const std::string& exercise,
                                      const std::function<void(const std::string&)>& tell) {
    std::vector<PastAttempt> history;
    std::error_code missing;
    for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
        if (entry.path().extension() != ".json") continue;
        try {
            constexpr std::uintmax_t most_bytes = 1 << 20;
            require_small_file(entry.path(), most_bytes);
            std::ifstream file(entry.path());
            const Json json = Json::parse(file, nullptr, false);
            if (json.is_discarded() || json.at("schema") != schema) throw std::runtime_error("");
            const Json& score = json.at("metrics").at("score");
            if (json.at("case") != case_name || json.at("exercise").at("name") != exercise ||
                json.at("ending") == words_of(Ending::cut_short) || score.is_null())
                continue;
            history.push_back({.when = json.at("when").get<std::string>(), .score = score.get<double>()});
        } catch (const std::exception&) {
            tell(entry.path().string() + " is not an attempt of Palpate's: left out of the history");
        }
    }
    std::ranges::sort(history, {}, &PastAttempt::when);
    return history;
}

}  // namespace palpate::training
