// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/training/exercise.hpp"
#include "runtime/training/goals.hpp"
#include "runtime/visual/lesson/lesson_view.hpp"

namespace palpate::apps {

/// Puts an exercise's marks, gates and line into the view, as far as `goals` have come. What a search is for
/// is shown `afterwards` only: the place, its outline, and what the trainee answered.
void show_places(const training::Exercise& exercise, const training::Goals& goals, bool afterwards,
                 visual::LessonView& view);

}  // namespace palpate::apps
