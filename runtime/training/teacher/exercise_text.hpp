// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "runtime/training/exercise_file.hpp"

namespace palpate::training {

/// An exercise as an [[exercise]] table of a TOML file: what read_exercises() makes of it is the same recipe,
/// bit for bit, but for `written_at`. Keys that say what is usual anyway are left out.
std::string exercise_text(const ExerciseRecipe& recipe);

/// The text of an exercise file with an exercise put in: in the place of the one of its name, or behind
/// everything else; whatever else stands there, comments too, stays as it is. An empty text becomes a file
/// with this exercise alone. `file` is what complaints call it. Throws InvalidInput where the text is no
/// TOML, or has its exercises otherwise than as [[exercise]] tables.
std::string with_exercise(const std::string& text, const ExerciseRecipe& recipe, const std::string& file);

}  // namespace palpate::training
