// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/exercises/editor_view.hpp"

#include <fmt/format.h>
#include <utility>

#include "runtime/apps/exercises/exercise_marks.hpp"
#include "runtime/texts/translated.hpp"

namespace palpate::apps {
namespace {

using namespace training;
using namespace visual;
using texts::looked_up;
using texts::translated;

constexpr double point_radius = 1;  // mm, of a line's points

// `region`: that the exercise hides.
std::pair<std::string, std::string> name_and_value(Setting setting, const ExerciseRecipe& recipe,
                                                   const std::string& region) {
    switch (setting) {
        case Setting::task:
            return {translated("Task"), std::string(looked_up(name_of(recipe.task).data()))};
        case Setting::title:
            return {translated("Title"), recipe.title};
        case Setting::region:
            return {translated("Hidden"), region};
        case Setting::least_force:
            return {translated("Touching from"), fmt::format("{:g} N", *recipe.least_force)};
        case Setting::most_force:
            return {translated("Most force"), fmt::format("{:g} N", *recipe.most_force)};
        case Setting::tolerance:
            return {translated("Tolerance"), fmt::format("{:g} mm", *recipe.tolerance)};
        case Setting::hold:
            return {translated("Held for"), fmt::format("{:g} s", *recipe.hold)};
        case Setting::time_limit:
            break;
    }
    return {translated("Time limit"),
            recipe.time_limit ? fmt::format("{:g} s", *recipe.time_limit) : translated("none")};
}

std::string marks_of(const ExerciseRecipe& recipe) {
    if (recipe.task == Task::find || recipe.task == Task::free) return "";
    const std::size_t count = recipe.places.size();
    if (recipe.task == Task::retract)
        return count == 0   ? translated("no rim")
               : count == 3 ? translated("rim and place")
                            : translated("rim alone");
    return recipe.task == Task::guide   ? translated("{} gates", count)
           : recipe.task == Task::trace ? translated("{} points", count)
                                        : translated("{} marks", count);
}

std::string how_to_mark(Task task) {
    switch (task) {
        case Task::guide:
            return translated("Lead the tip to where a gate is to be, press M");
        case Task::retract:
            return translated("Close the jaws on a rim, press M; draw it to its place, press M again");
        default:
            return translated("Touch the organ where a mark is to be, press M");
    }
}

LessonPage page_of(const ExerciseEditor& editor, const ExerciseRecipe& recipe, const std::string& region,
                   const std::string& file) {
    LessonPage page;
    page.title = translated("Exercise {}", recipe.name);
    page.text = editor.typing()            ? translated("Type the title; Enter ends")
                : editor.message().empty() ? translated("A digit chooses, + and - change")
                                           : std::string(looked_up(editor.message().c_str()));
    // While a title is typed, nothing else is to be chosen.
    const auto add = [&](const char* key, std::string text) {
        page.choices.push_back({editor.typing() ? "" : key, std::move(text)});
    };
    int number = 0;
    for (const Setting setting : editor.settings()) {
        ++number;
        const auto [name, value] = name_and_value(setting, recipe, region);
        const bool chosen = setting == editor.chosen();
        const char* mark = !chosen                     ? ""
                           : setting == Setting::title ? (editor.typing() ? "_" : "")
                                                       : "   \u2212 +";
        add(std::to_string(number).c_str(),
            fmt::format("{}{}   {}: {}{}", chosen ? "\u203a " : "   ", number, name, value, mark));
    }
    add("plus", "+   " + translated("More"));
    add("minus", "\u2212   " + translated("Less"));
    if (editor.chosen() == Setting::least_force || editor.chosen() == Setting::most_force)
        add("f", "F   " + translated("As felt now"));
    if (const std::string marks = marks_of(recipe); !marks.empty())
        add("space", translated("Space") + "   " + translated("To the organ, to set marks ({})", marks));
    add("t", "T   " + translated("Try it"));
    add("s", "S   " + translated("Save to {}", file));
    add("backspace", translated("Backspace") + "   " + translated("Leave"));
    return page;
}

}  // namespace

LessonView editor_view(const ExerciseEditor& editor, const Exercise& draft, const std::string& file) {
    const ExerciseRecipe recipe = editor.recipe();
    LessonView view;
    show_places(draft, {}, false, view);
    if (recipe.task == Task::trace)
        for (const Eigen::Vector3d& place : recipe.places)
            view.marks.push_back({place, point_radius, LessonMark::State::waiting, Eigen::Vector3d::Zero()});
    view.takes_keys = editor.page_shown();
    if (editor.page_shown()) {
        view.page = page_of(editor, recipe, draft.region, file);
        return view;
    }
    view.instruction = how_to_mark(recipe.task);
    // Set by a key or the device alone: a mouse that clicks does not touch.
    view.status = marks_of(recipe) + "   " + translated("M sets one");
    view.actions = {{"delete", translated("Delete") + "  " + translated("Take the last back")},
                    {"space", translated("Space") + "  " + translated("The settings")}};
    view.warning = looked_up(editor.message().c_str());
    view.least_force = recipe.least_force.value_or(0);
    view.most_force = recipe.most_force.value_or(0);
    return view;
}

}  // namespace palpate::apps
