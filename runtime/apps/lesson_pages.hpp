// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

#include "runtime/training/attempt_record.hpp"
#include "runtime/training/lesson.hpp"
#include "runtime/visual/lesson/lesson_view.hpp"

namespace palpate::apps {

/// What does not change while a lesson goes on.
struct LessonSetting {
    std::string case_name, trainee;
    std::vector<std::string> cautions;  ///< of the case
};

/// What the window shows of a lesson. `force`: N, on the device; `history`: of the exercise that was chosen
/// last, its newest attempt included.
visual::LessonView lesson_view(const training::Lesson& lesson, const LessonSetting& setting, double force,
                               std::span<const training::PastAttempt> history);

}  // namespace palpate::apps
