// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "runtime/training/attempt_record.hpp"

namespace palpate::training {

/// An attempt as xAPI 1.0.3 statements in the form of cmi5's own, in their order: "initialized", "completed"
/// if it came to its end, "passed" or "failed" then if the exercise has goals, "terminated". Passed means
/// that all goals were reached, of a search that it was found; there is no mastery score. Actor: an account
/// of the pseudonym at https://palpate.invalid/trainee. Object: the exercise on that case, grouped under the
/// case. Each attempt is a session and a registration of its own, for no learning system launched it. Ids are
/// made from the content, so that the same attempt gives the same statements. Sources: xAPI-Spec 1.0.3, part
/// two; cmi5 (quartz), sections 7.1.3 and 9.
std::vector<nlohmann::ordered_json> statements_of(const AttemptHead& head, const Attempt& attempt);

}  // namespace palpate::training
