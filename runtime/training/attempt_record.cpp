// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/attempt_record.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>

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
