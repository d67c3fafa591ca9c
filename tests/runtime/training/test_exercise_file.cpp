// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/training/exercise_file.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace training;
using ::testing::HasSubstr;

class ExerciseFile : public ::testing::Test {
  protected:
    std::filesystem::path written(const std::string& text) {
        const auto path = scratch_ / "exercises.toml";
        std::ofstream(path) << text;
        return path;
    }
    std::string refusal_of(const std::string& exercise) {
        const auto path = written("schema = 1\n[[exercise]]\n" + exercise);
        return sample::refusal([&] { read_exercises(path); });
    }
    sample::Scratch scratch_;
};

TEST_F(ExerciseFile, says_everything_of_an_exercise) {
    const auto recipes = read_exercises(written(R"(schema = 1
[[exercise]]
name = "nose"
task = "guide"
title = "Through the nose"
instruction = "Slowly."
time_limit_s = 120
most_force_n = 0.4
least_force_n = 0.02
tolerance_mm = 4
places_mm = [[1, 2.5, 3], [4, 5, 6]]
[[exercise]]
name = "marks"
task = "touch"
count = 7
seed = 3
hold_s = 1
spread_mm = 25
)"));
    ASSERT_EQ(recipes.size(), 2U);
    EXPECT_EQ(recipes[0].task, Task::guide);
    EXPECT_EQ(recipes[0].title, "Through the nose");
    EXPECT_EQ(recipes[0].time_limit, 120);
    EXPECT_EQ(recipes[0].most_force, 0.4);
    EXPECT_EQ(recipes[0].places.at(0), Eigen::Vector3d(1, 2.5, 3));
    EXPECT_EQ(recipes[1].title, "marks");
    EXPECT_EQ(recipes[1].count, 7);
    EXPECT_EQ(recipes[1].seed, 3U);
    EXPECT_EQ(recipes[1].spread, 25);
    EXPECT_FALSE(recipes[1].tolerance);
}

TEST_F(ExerciseFile, what_cannot_be_is_told_with_file_line_and_key) {
    EXPECT_THAT(refusal_of("name = \"a\"\ntask = \"toch\"\n"),
                AllOf(HasSubstr("exercises.toml:4"), HasSubstr("touch")));
    EXPECT_THAT(refusal_of("name = \"a b\"\ntask = \"free\"\n"), HasSubstr("exercises.toml:3"));
    EXPECT_THAT(refusal_of("name = \"a\"\ntask = \"free\"\ntime_limit = 3\n"), HasSubstr("time_limit_s"));
    EXPECT_THAT(refusal_of("name = \"a\"\ntask = \"guide\"\n"), HasSubstr("gates"));
    EXPECT_THAT(refusal_of("name = \"a\"\ntask = \"trace\"\nplaces_mm = [[1, 2]]\n"),
                HasSubstr("[[x, y, z]"));
    EXPECT_THAT(refusal_of("name = \"a\"\ntask = \"touch\"\ncount = 0\n"), HasSubstr("1 to 1000"));
    EXPECT_THAT(refusal_of("name = \"a\"\ntask = \"touch\"\nleast_force_n = 2\nmost_force_n = 1\n"),
                HasSubstr("least_force_n"));
    EXPECT_THAT(refusal_of("name = \"a\"\ntask = \"free\"\n[[exercise]]\nname = \"a\"\ntask = \"free\"\n"),
                HasSubstr("second time"));
    EXPECT_THAT(sample::refusal([&] { read_exercises(written("schema = 1\n")); }), HasSubstr("exercise"));
    EXPECT_THAT(sample::refusal([&] { read_exercises(written("schema = 2\n")); }), HasSubstr("schema"));
    std::string many, deep = "a", long_one = "#";
    for (int i = 0; i <= 1000; ++i) many += "[[exercise]]\n";
    for (int i = 0; i < 5000; ++i) deep += ".a";
    long_one.resize(1 << 20, ' ');
    const auto refused = [&](const std::string& text) {
        return sample::refusal([&] { read_exercises(written("schema = 1\n" + text)); });
    };
    EXPECT_THAT(refused(many), HasSubstr("is there 1001 times (expected 1000 at most)"));
    EXPECT_THAT(refused(deep + " = 1\n"), HasSubstr("has 5000 full stops in keys (expected 4096 at most"));
    EXPECT_THAT(refused(long_one), HasSubstr("bytes (expected 1048576 at most)"));
}

TEST_F(ExerciseFile, every_patient_has_the_standard_ones) {
    std::vector<std::string> names;
    for (const ExerciseRecipe& recipe : standard_exercises(false)) names.push_back(recipe.name);
    EXPECT_THAT(names, ::testing::ElementsAre("touch", "find", "trace", "free"));
}

}  // namespace
}  // namespace palpate
