// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/training/teacher/exercise_editor.hpp"

namespace palpate {
namespace {

using namespace training;
using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Editor : public ::testing::Test {
  protected:
    static ExerciseRecipe draft(Task task) {
        ExerciseRecipe recipe;
        recipe.name = recipe.title = "mine";
        recipe.task = task;
        recipe.least_force = 0.05;
        recipe.most_force = 0.45;
        recipe.tolerance = 2.5;
        recipe.hold = 0.5;
        return recipe;
    }
    static HandNow touching(const Vector3d& place, double force = 0.1) {
        return {.tool = place + Vector3d(0, 0, 1.5), .force = force, .touched = place};
    }
    Wish press(std::initializer_list<std::string_view> keys, const HandNow& hand = {}) {
        Wish wish = Wish::nothing;
        for (const std::string_view key : keys) wish = editor_.press(key, hand);
        return wish;
    }
    static Choices choices(std::vector<std::string> taken = {}) {
        return {.tasks = tasks_of(false), .regions = {"tumour", "vein"}, .taken = std::move(taken)};
    }
    ExerciseEditor editor_{draft(Task::touch), choices({"touch-1", "mine"})};
};

TEST_F(Editor, sets_marks_where_the_organ_is_touched_and_takes_them_back) {
    press({"space"});
    EXPECT_FALSE(editor_.page_shown());
    press({"m"});
    EXPECT_THAT(editor_.message(), HasSubstr("touch the organ"));
    press({"m"}, touching({1, 2, 3.00004}));
    press({"M"}, touching({4, 5, 6}));
    press({"m", "Delete"}, touching({7, 8, 9}));
    EXPECT_THAT(editor_.recipe().places, ElementsAre(Vector3d(1, 2, 3), Vector3d(4, 5, 6)));
    press({"Delete", "Delete", "Delete"});
    EXPECT_TRUE(editor_.recipe().places.empty());
    EXPECT_THAT(editor_.message(), HasSubstr("no mark"));
}

TEST_F(Editor, sets_gates_where_the_tip_is_without_touching_anything) {
    editor_ = ExerciseEditor(draft(Task::guide), choices());
    press({"space"});
    press({"m"}, {.tool = {1, 2, 3}, .force = 0, .touched = {}});
    EXPECT_THAT(editor_.recipe().places, ElementsAre(Vector3d(1, 2, 3)));
}

TEST_F(Editor, of_a_forceps_sets_the_rim_that_is_held_and_then_where_it_is_drawn) {
    const HandNow holding{
        .tool = {0, 0, 10}, .force = 0.1, .touched = Vector3d(0, 0, 14), .rim = Vector3d(0, 0, 18)};
    editor_ = ExerciseEditor(draft(Task::retract), {.tasks = tasks_of(true), .regions = {}});
    EXPECT_EQ(press({"t"}), Wish::nothing);
    EXPECT_THAT(editor_.message(), HasSubstr("hold a rim"));
    press({"space", "m"}, {.tool = {0, 0, 10}});
    EXPECT_THAT(editor_.message(), HasSubstr("take hold"));
    press({"m"}, holding);
    EXPECT_THAT(editor_.recipe().places, ElementsAre(Vector3d(0, 0, 18), Vector3d(0, 0, 10)));
    press({"m"}, holding);
    EXPECT_THAT(editor_.message(), HasSubstr("farther"));
    press({"m"}, {.tool = {0, 0, 15}});
    press({"m"}, {.tool = {0, 0, 16}});
    EXPECT_THAT(editor_.message(), HasSubstr("are set"));
    EXPECT_EQ(press({"space", "s"}), Wish::save);
    EXPECT_THAT(editor_.recipe().places,
                ElementsAre(Vector3d(0, 0, 18), Vector3d(0, 0, 10), Vector3d(0, 0, 15)));
    EXPECT_EQ(editor_.recipe().hold, 0.5);
    press({"space", "Delete"});
    EXPECT_EQ(editor_.recipe().places.size(), 2U);
    press({"Delete"});
    EXPECT_TRUE(editor_.recipe().places.empty());
    press({"space", "1", "plus"});
    EXPECT_EQ(editor_.recipe().task, Task::free);
    press({"plus"});
    EXPECT_EQ(editor_.recipe().task, Task::retract) << "a forceps has no other";
    press({"space", "m"}, holding);
    press({"m"}, {.tool = {0, 0, 15}});
    press({"space", "5", "plus", "plus", "plus", "plus", "plus", "plus"});
    EXPECT_EQ(press({"s"}), Wish::nothing);
    EXPECT_THAT(editor_.message(), HasSubstr("farther"));
    press({"1", "plus", "space", "Delete", "space", "1", "plus"});
    EXPECT_TRUE(editor_.recipe().places.empty()) << "none of another task's are left";
}

TEST_F(Editor, goes_through_the_regions_that_a_search_may_hide) {
    press({"1", "plus"});
    ASSERT_EQ(editor_.settings()[2], Setting::region);
    EXPECT_EQ(editor_.recipe().region, "");
    press({"3", "plus"});
    EXPECT_EQ(editor_.recipe().region, "vein");
    press({"plus"});
    EXPECT_EQ(editor_.recipe().region, "tumour");
    press({"1", "plus"});
    EXPECT_EQ(editor_.recipe().region, "") << "no other task hides anything";
    editor_ = ExerciseEditor(draft(Task::find), {.tasks = tasks_of(false), .regions = {"tumour"}});
    press({"3", "minus"});
    EXPECT_THAT(editor_.message(), HasSubstr("nothing else"));
    editor_ = ExerciseEditor(draft(Task::find), {.tasks = tasks_of(false), .regions = {}});
    EXPECT_NE(editor_.settings()[2], Setting::region);
}

TEST_F(Editor, changes_what_is_chosen_in_steps_that_read_well) {
    press({"4", "plus", "KP_Add", "minus"});
    EXPECT_EQ(editor_.recipe().most_force, 0.46);
    press({"Up", "left"});
    EXPECT_EQ(editor_.recipe().least_force, 0.049);
    press({"5", "Right"});
    EXPECT_EQ(editor_.recipe().tolerance, 3);
    press({"Down", "minus"});
    EXPECT_EQ(editor_.recipe().hold, 0.4);
    press({"7", "plus", "plus"});
    EXPECT_EQ(editor_.recipe().time_limit, 20);
    press({"minus", "minus"});
    EXPECT_FALSE(editor_.recipe().time_limit);
    for (int i = 0; i < 20; ++i) press({"5", "minus"});
    EXPECT_EQ(editor_.recipe().tolerance, 0.5);
}

TEST_F(Editor, takes_the_force_that_is_felt_and_keeps_the_least_below_the_most) {
    press({"4", "f"}, touching({0, 0, 0}, 0.31234));
    EXPECT_EQ(editor_.recipe().most_force, 0.31);
    press({"f"});
    EXPECT_THAT(editor_.message(), HasSubstr("no force"));
    press({"3", "f"}, touching({0, 0, 0}, 0.5));
    EXPECT_THAT(editor_.message(), HasSubstr("below"));
    EXPECT_EQ(editor_.recipe().least_force, 0.05);
    press({"1", "f"}, touching({0, 0, 0}, 0.5));
    EXPECT_THAT(editor_.message(), HasSubstr("first choose"));
}

TEST_F(Editor, names_a_new_exercise_after_its_task_and_keeps_the_name_of_an_old_one) {
    EXPECT_EQ(editor_.recipe().name, "touch-2");
    press({"1", "plus"});
    EXPECT_EQ(editor_.recipe().task, Task::find);
    EXPECT_EQ(editor_.recipe().name, "find-1");
    EXPECT_EQ(editor_.recipe().title, "find-1");
    EXPECT_EQ(editor_.recipe().instruction, usual_instruction(Task::find));
    editor_ = ExerciseEditor(draft(Task::touch), choices());
    press({"1", "minus"});
    EXPECT_EQ(editor_.recipe().task, Task::free);
    EXPECT_EQ(editor_.recipe().name, "mine");
}

TEST_F(Editor, types_a_title_with_every_key_until_enter) {
    press({"2", "BackSpace"});
    for (int i = 0; i < 20; ++i) press({"BackSpace"});
    press({"L", "e", "f", "t", "space", "l", "o", "b", "e", "minus", "2", "s", "Shift_L", "Return"});
    EXPECT_FALSE(editor_.typing());
    EXPECT_EQ(editor_.recipe().title, "Left lobe-2s");
    press({"1", "plus"});
    EXPECT_EQ(editor_.recipe().title, "Left lobe-2s") << "stays, whatever the task";
}

TEST_F(Editor, tries_and_saves_what_has_its_marks_only) {
    EXPECT_EQ(press({"t"}), Wish::nothing);
    EXPECT_THAT(editor_.message(), HasSubstr("a mark first"));
    press({"space"});
    press({"m"}, touching({1, 2, 3}));
    press({"space"});
    EXPECT_EQ(press({"t"}), Wish::attempt);
    EXPECT_EQ(press({"s"}), Wish::save);
    EXPECT_EQ(press({"1", "minus", "minus", "s"}), Wish::nothing) << "a line of one point";
    EXPECT_EQ(press({"backspace"}), Wish::leave);
}

TEST_F(Editor, gives_a_recipe_only_what_its_task_knows) {
    ExerciseRecipe recipe = draft(Task::touch);
    recipe.places = {Vector3d::Zero()};
    recipe.count = 9;
    editor_ = ExerciseEditor(recipe, choices());
    EXPECT_EQ(editor_.recipe(), recipe);
    press({"1", "minus"});
    EXPECT_TRUE(editor_.recipe().places.empty());
    EXPECT_FALSE(editor_.recipe().tolerance);
    EXPECT_EQ(editor_.recipe().count, 5);
    press({"plus"});
    EXPECT_EQ(editor_.recipe(), recipe) << "nothing was lost on the way";
}

TEST(SettledRecipe, has_the_forces_and_places_that_were_found_on_the_patient) {
    ExerciseRecipe recipe;
    recipe.task = Task::touch;
    const Exercise exercise{.name = "x",
                            .title = "",
                            .instruction = "",
                            .task = Task::touch,
                            .time_limit = 0,
                            .least_force = 0.02,
                            .most_force = 0.2,
                            .tolerance = 3,
                            .hold = 0.5,
                            .places = {{1, 2, 3}},
                            .region = ""};
    const ExerciseRecipe made = settled(recipe, exercise);
    EXPECT_EQ(made.least_force, 0.02);
    EXPECT_EQ(made.most_force, 0.2);
    EXPECT_EQ(made.places, exercise.places);
    recipe.places = {{9, 9, 9}};
    EXPECT_EQ(settled(recipe, exercise).places, recipe.places);
}

}  // namespace
}  // namespace palpate
