// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "runtime/training/exercise.hpp"
#include "runtime/training/teacher/exercise_editor.hpp"
#include "runtime/visual/lesson/lesson_view.hpp"

namespace palpate::apps {

/// What the window shows while a teacher makes an exercise: the page with its settings, or the organ with its
/// marks. `draft`: the exercise as it lies on the patient so far; `file`: the name of the one that keeps it.
visual::LessonView editor_view(const training::ExerciseEditor& editor, const training::Exercise& draft,
                               const std::string& file);

}  // namespace palpate::apps
