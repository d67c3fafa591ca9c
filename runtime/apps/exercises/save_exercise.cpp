// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/exercises/save_exercise.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>

#include "formats/model/errors.hpp"
#include "runtime/training/teacher/exercise_text.hpp"
#include "tools/cli/outputs/staged_file.hpp"

namespace palpate::apps {

using namespace training;

std::filesystem::path usual_exercise_file(const std::filesystem::path& asset) {
    return asset.parent_path() / (asset.stem().string() + "-exercises.toml");
}

void save_exercise(const std::filesystem::path& file, const ExerciseRecipe& recipe) {
    std::ifstream stream(file, std::ios::binary);
    const std::string before{std::istreambuf_iterator<char>(stream), {}};
    cli::StagedFile staged(file, true);
    staged.write_text(with_exercise(before, recipe, file.string()));
    const std::vector<ExerciseRecipe> read = read_exercises(staged.path());
    ExerciseRecipe written = recipe;
    const auto same = std::ranges::find(read, recipe.name, &ExerciseRecipe::name);
    if (same != read.end()) written.written_at = same->written_at;
    if (same == read.end() || *same != written)
        throw InvalidInput({file.string(), "cannot be extended by '" + recipe.name + "'", "",
                            "write the exercise into another file"});
    staged.commit();
}

}  // namespace palpate::apps
