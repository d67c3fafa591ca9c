// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "runtime/training/attempt.hpp"

namespace palpate::training {

/// Who did what, when and with what.
struct AttemptHead {
    std::string trainee;  ///< a pseudonym: see is_pseudonym()
    std::string began;    ///< UTC, "2026-03-01T09:28:40Z"
    std::string when;     ///< of the end, likewise
    std::string case_name;
    std::string device;
    std::string scheme;   ///< the contact method's name
    std::string version;  ///< of Palpate
};

/// Whether a text can stand for a trainee in names of files and in statements: 1 to 40 letters, digits, '-'
/// and
/// '_'.
bool is_pseudonym(const std::string& text);

/// An attempt as files and --json have it, "palpate.attempt/1": who, what, how it ended, the exercise as it
/// lay on the patient, the border's marks of a search, every metric by its name and unit. Metrics that are
/// not defined are null.
nlohmann::ordered_json attempt_json(const AttemptHead& head, const Attempt& attempt);

/// The hand's way and force as CSV, one row every hundredth of a second: time_s, x_mm, y_mm, z_mm (frame P),
/// force_n, depth_mm.
std::string attempt_csv(const Attempt& attempt);

/// What is known of an earlier attempt.
struct PastAttempt {
    std::string when;
    double score = 0;  ///< 0 to 100
};

/// A trainee's earlier attempts at an exercise on a case that have a score and were not cut short, by time:
/// the .json files of a folder. Files that cannot be read, are something else or have more than 1 MiB are
/// named to `tell` and left out. None if there is no such folder.
std::vector<PastAttempt> read_history(const std::filesystem::path& folder, const std::string& case_name,
                                      const std::string& exercise,
                                      const std::function<void(const std::string&)>& tell);

}  // namespace palpate::training
