// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/training/teacher/exercise_text.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace training;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class ExerciseText : public ::testing::Test {
  protected:
    std::vector<ExerciseRecipe> read(const std::string& text) {
        const auto path = scratch_ / "exercises.toml";
        std::ofstream(path) << text;
        auto recipes = read_exercises(path);
        for (ExerciseRecipe& recipe : recipes) recipe.written_at.clear();
        return recipes;
    }
    static ExerciseRecipe recipe_of(Task task, const std::string& name) {
        ExerciseRecipe recipe;
        recipe.name = recipe.title = name;
        recipe.task = task;
        return recipe;
    }
    sample::Scratch scratch_;
};

TEST_F(ExerciseText, is_read_as_the_same_exercise) {
    ExerciseRecipe marks = recipe_of(Task::touch, "marks-2");
    marks.title = "Say \"ah\", \\ then\tpress: \xc3\xa4";
    marks.instruction = "Two lines\nof text";
    marks.time_limit = 90;
    marks.least_force = 0.0125;
    marks.most_force = 0.1 + 0.2;
    marks.tolerance = 3;
    marks.hold = 0.7;
    marks.count = 7;
    marks.seed = 3;
    marks.spread = 25.5;
    marks.places = {{1, -2.5, 3e-7}, {1234567.125, 1e22, -0.1}};
    ExerciseRecipe search = recipe_of(Task::find, "search");
    search.region = "tumour";
    ExerciseRecipe passage = recipe_of(Task::guide, "passage");
    passage.places = {{0, 0, 0}, {1, 2, 3}};
    ExerciseRecipe line = recipe_of(Task::trace, "line");
    line.places = {{0, 0, 0}, {1, 2, 3}};
    std::string text;
    const std::vector recipes{marks, search, passage, line, recipe_of(Task::free, "free")};
    for (const ExerciseRecipe& recipe : recipes) text = with_exercise(text, recipe, "a.toml");
    EXPECT_EQ(read(text), recipes);
}

TEST_F(ExerciseText, leaves_what_else_stands_in_the_file_as_it_is) {
    const std::string before =
        "# of our clinic\nschema = 1\n\n[[exercise]]\nname = \"a\" # the first\ntask = \"free\"";
    const std::string text = with_exercise(before, recipe_of(Task::find, "b"), "a.toml");
    EXPECT_THAT(text, StartsWith(before + "\n"));
    EXPECT_EQ(read(text).size(), 2U);
}

TEST_F(ExerciseText, takes_the_place_of_the_exercise_of_its_name) {
    const std::string
        first = "schema = 1\n[[exercise]]\nname = \"a\"\ntask = \"free\"\n\n",
        old =
            "[[exercise]]\ntask = \"trace\"\nname = \"b\"\nplaces_mm = [\n[1, 2, 3], # here\n[4, 5, 6]\n]\n",
        last = "\n# the last one\n[[exercise]]\nname = \"c\"\ntask = \"find\"\n# the end\n";
    const ExerciseRecipe recipe = recipe_of(Task::free, "b");
    const std::string text = with_exercise(first + old + last, recipe, "a.toml");
    EXPECT_EQ(text, first + exercise_text(recipe) + last);
    EXPECT_EQ(read(text).at(1), recipe);
    EXPECT_EQ(with_exercise(text, recipe, "a.toml"), text);
    const std::string end = with_exercise(text, recipe_of(Task::free, "c"), "a.toml");
    EXPECT_THAT(end, EndsWith("# the end\n"));
    EXPECT_EQ(read(end).at(2).task, Task::free);
}

TEST_F(ExerciseText, is_refused_by_a_file_that_it_cannot_be_put_into) {
    const auto refusal = [](const std::string& text) {
        return sample::refusal([&] { with_exercise(text, recipe_of(Task::free, "b"), "a.toml"); });
    };
    EXPECT_THAT(refusal("schema = 1\nexercise = oh\n"), HasSubstr("a.toml:2"));
    EXPECT_THAT(refusal("schema = 1\nexercise = [{ name = \"a\", task = \"free\" }]\n"),
                HasSubstr("[[exercise]]"));
}

}  // namespace
}  // namespace palpate
