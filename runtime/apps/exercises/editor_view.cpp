// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/exercises/editor_view.hpp"

#include <fmt/format.h>
#include <utility>

#include "runtime/apps/exercises/exercise_marks.hpp"

namespace palpate::apps {
namespace {

using namespace training;
using namespace visual;

constexpr double point_radius = 1;  // mm, of a line's points

std::pair<std::string, std::string> name_and_value(Setting setting, const ExerciseRecipe& recipe) {
    switch (setting) {
        case Setting::task:
            return {"Task", std::string(name_of(recipe.task))};
        case Setting::title:
            return {"Title", recipe.title};
        case Setting::least_force:
            return {"Touching from", fmt::format("{:g} N", *recipe.least_force)};
        case Setting::most_force:
            return {"Most force", fmt::format("{:g} N", *recipe.most_force)};
        case Setting::tolerance:
            return {"Tolerance", fmt::format("{:g} mm", *recipe.tolerance)};
        case Setting::hold:
            return {"Held for", fmt::format("{:g} s", *recipe.hold)};
        case Setting::time_limit:
            break;
    }
    return {"Time limit", recipe.time_limit ? fmt::format("{:g} s", *recipe.time_limit) : "none"};
}

std::string marks_of(const ExerciseRecipe& recipe) {
    if (recipe.task == Task::find || recipe.task == Task::free) return "";
    const char* what = recipe.task == Task::guide ? "gates" : recipe.task == Task::trace ? "points" : "marks";
    return fmt::format("{} {}", recipe.places.size(), what);
}

LessonPage page_of(const ExerciseEditor& editor, const ExerciseRecipe& recipe, const std::string& file) {
    LessonPage page;
    page.title = "Exercise " + recipe.name;
    page.text = editor.typing()            ? "Type the title; Enter ends"
                : editor.message().empty() ? "A digit chooses, + and - change"
                                           : editor.message();
    // While a title is typed, nothing else is to be chosen.
    const auto add = [&](const char* key, std::string text) {
        page.choices.push_back({editor.typing() ? "" : key, std::move(text)});
    };
    int number = 0;
    for (const Setting setting : editor.settings()) {
        ++number;
        const auto [name, value] = name_and_value(setting, recipe);
        const bool chosen = setting == editor.chosen();
        const char* mark = !chosen                     ? ""
                           : setting == Setting::title ? (editor.typing() ? "_" : "")
                                                       : "   \u2212 +";
        add(std::to_string(number).c_str(),
            fmt::format("{}{}   {}: {}{}", chosen ? "\u203a " : "   ", number, name, value, mark));
    }
    add("plus", "+   More");
    add("minus", "\u2212   Less");
    if (editor.chosen() == Setting::least_force || editor.chosen() == Setting::most_force)
        add("f", "F   As felt now");
    if (const std::string marks = marks_of(recipe); !marks.empty())
        add("space", fmt::format("Space   To the organ, to set marks ({})", marks));
    add("t", "T   Try it");
    add("s", "S   Save to " + file);
    add("backspace", "Backspace   Leave");
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
        view.page = page_of(editor, recipe, file);
        return view;
    }
    view.instruction = recipe.task == Task::guide ? "Lead the tip to where a gate is to be, press M"
                                                  : "Touch the organ where a mark is to be, press M";
    view.status = marks_of(recipe) + "   M sets, Delete takes the last back, Space: the settings";
    view.warning = editor.message();
    view.least_force = recipe.least_force.value_or(0);
    view.most_force = recipe.most_force.value_or(0);
    return view;
}

}  // namespace palpate::apps
