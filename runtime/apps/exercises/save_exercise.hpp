// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "runtime/training/exercise_file.hpp"

namespace palpate::apps {

/// The file that keeps an asset's exercises if no other is named, beside it: "liver-exercises.toml" of
/// "liver.vtkhdf".
std::filesystem::path usual_exercise_file(const std::filesystem::path& asset);

/// Puts an exercise into a file, a new one if there is none: see with_exercise(). The file appears whole, and
/// only once read_exercises() has read the same recipe from it; otherwise the old one stays. Throws
/// InvalidInput for a file that cannot be extended, SystemFailure if it cannot be written.
void save_exercise(const std::filesystem::path& file, const training::ExerciseRecipe& recipe);

}  // namespace palpate::apps
