// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
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

/// The page after an attempt: metrics, force and the scores of `history`, its own included. `watchable`: it
/// was recorded. Costs the attempt's metrics: once an attempt, not once a frame.
visual::LessonPage result_page(const training::Attempt& attempt, bool watchable,
                               std::span<const training::PastAttempt> history);

/// The page on which another pseudonym is typed; `typed`: so far.
visual::LessonView trainee_view(const std::string& typed, const LessonSetting& setting);

/// Has an attempt that is looked back at shown again in place of its page.
void show_review(visual::LessonView& view);

/// What the window shows of a lesson. `force`: N, on the device; `tip`: of the tool, p_P, mm; `result`: of
/// the attempt that is looked back at.
visual::LessonView lesson_view(const training::Lesson& lesson, const LessonSetting& setting, double force,
                               const Eigen::Vector3d& tip, const visual::LessonPage& result);

}  // namespace palpate::apps
