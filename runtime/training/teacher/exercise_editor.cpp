// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/teacher/exercise_editor.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <utility>

#include "formats/records/shown_text.hpp"

namespace palpate::training {
namespace {

using Eigen::Vector3d;

constexpr double least_settable = 1e-4;  // N
constexpr double tolerance_step = 0.5;   // mm
constexpr double hold_step = 0.1;        // s
constexpr double time_step = 10;         // s
constexpr std::size_t longest_title = 40;

// To four decimals, which a file shows without a tail of digits.
double four_decimals(double value) {
    return std::round(value * 1e4) / 1e4;
}

Vector3d four_decimals(const Vector3d& p) {
    return {four_decimals(p.x()), four_decimals(p.y()), four_decimals(p.z())};
}

// What the second of a force's digits counts.
double second_digit(double newtons) {
    return std::max(least_settable, std::pow(10, std::floor(std::log10(newtons) + 1e-9) - 1));
}

double stepped(double value, double step, int ways, double least) {
    return four_decimals(std::max(least, (std::round(value / step) + ways) * step));
}

// How many places an exercise of a task needs, of those that a person sets.
std::size_t least_places(Task task) {
    switch (task) {
        case Task::touch:
            return 1;
        case Task::guide:
        case Task::trace:
            return 2;
        case Task::retract:
            return 3;
        case Task::find:
        case Task::free:
            break;
    }
    return 0;
}

// Whether a place is far enough off where a rim was held to be drawn to: nearer, holding alone would do.
bool is_drawn_to(const Vector3d& place, const ExerciseRecipe& recipe) {
    return (place - recipe.places[1]).norm() > *recipe.tolerance;
}

// The value so many places on, round and round.
template <typename Value>
Value turned(const std::vector<Value>& values, const Value& now, int ways) {
    const auto count = static_cast<int>(values.size());
    const auto at = static_cast<int>(std::ranges::find(values, now) - values.begin()) % count;
    return values[static_cast<std::size_t>((at + ways + count) % count)];
}

}  // namespace

std::vector<Task> tasks_of(bool with_forceps) {
    if (with_forceps) return {Task::retract, Task::free};
    return {Task::touch, Task::find, Task::guide, Task::trace, Task::free};
}

std::string free_exercise_name(Task task, std::span<const std::string> taken) {
    for (int number = 1;; ++number) {
        std::string name = fmt::format("{}-{}", name_of(task), number);
        if (std::ranges::find(taken, name) == taken.end()) return name;
    }
}

char typed_letter(std::string_view key) {
    constexpr std::array<std::pair<std::string_view, char>, 9> named{{{"space", ' '},
                                                                      {"underscore", '_'},
                                                                      {"minus", '-'},
                                                                      {"comma", ','},
                                                                      {"period", '.'},
                                                                      {"colon", ':'},
                                                                      {"apostrophe", '\''},
                                                                      {"parenleft", '('},
                                                                      {"parenright", ')'}}};
    if (key.size() == 1) return key[0];
    const auto found = std::ranges::find(named, key, &std::pair<std::string_view, char>::first);
    return found != named.end() ? found->second : '\0';
}

ExerciseRecipe settled(ExerciseRecipe recipe, const Exercise& exercise) {
    recipe.least_force = four_decimals(exercise.least_force);
    recipe.most_force = four_decimals(exercise.most_force);
    recipe.tolerance = exercise.tolerance;
    recipe.hold = exercise.hold;
    if (recipe.places.empty() && least_places(recipe.task) > 0)
        std::ranges::transform(exercise.places, std::back_inserter(recipe.places),
                               [](const Vector3d& place) { return four_decimals(place); });
    return recipe;
}

ExerciseEditor::ExerciseEditor(ExerciseRecipe draft, Choices choices)
    : draft_(std::move(draft)), choices_(std::move(choices)) {
    if (choices_.taken.empty()) return;
    draft_.name = draft_.title = free_exercise_name(draft_.task, choices_.taken);
    draft_.instruction = usual_instruction(draft_.task);
}

ExerciseRecipe ExerciseEditor::recipe() const {
    const ExerciseRecipe usual;
    ExerciseRecipe recipe = draft_;
    const Task task = recipe.task;
    if (task == Task::free) recipe.tolerance = std::nullopt;
    if (task != Task::touch && task != Task::retract) recipe.hold = std::nullopt;
    if (task != Task::touch) {
        recipe.count = usual.count;
        recipe.seed = usual.seed;
    }
    if (task != Task::touch && task != Task::trace) recipe.spread = usual.spread;
    if (task != Task::find) recipe.region.clear();
    if (least_places(task) == 0) recipe.places.clear();
    if (recipe.title.empty()) recipe.title = recipe.name;
    return recipe;
}

std::vector<Setting> ExerciseEditor::settings() const {
    std::vector<Setting> settings{Setting::task, Setting::title};
    if (draft_.task == Task::find && !choices_.regions.empty()) settings.push_back(Setting::region);
    settings.insert(settings.end(), {Setting::least_force, Setting::most_force});
    if (draft_.task != Task::free) settings.push_back(Setting::tolerance);
    if (draft_.task == Task::touch || draft_.task == Task::retract) settings.push_back(Setting::hold);
    settings.push_back(Setting::time_limit);
    return settings;
}

Wish ExerciseEditor::press(std::string_view key, const HandNow& hand) {
    if (typing_) {
        type(key);
        return Wish::nothing;
    }
    std::string lower(key);
    std::ranges::transform(lower, lower.begin(), [](unsigned char letter) { return std::tolower(letter); });
    if (lower == "space") {
        page_shown_ = !page_shown_;
        message_.clear();
        return Wish::nothing;
    }
    if (page_shown_) return press_on_page(lower, hand);
    press_on_organ(lower, hand);
    return Wish::nothing;
}

void ExerciseEditor::press_on_organ(std::string_view key, const HandNow& hand) {
    if (key == "m") mark(hand);
    if (key == "delete" && least_places(draft_.task) > 0) take_mark_back();
}

void ExerciseEditor::take_mark_back() {
    message_ = draft_.places.empty() ? shown_text("there is no mark") : "";
    if (draft_.places.empty()) return;
    draft_.places.pop_back();
    // A rim and the tips that held it are one mark.
    if (draft_.task == Task::retract && draft_.places.size() == 1) draft_.places.clear();
}

void ExerciseEditor::mark(const HandNow& hand) {
    message_.clear();
    if (draft_.task == Task::retract)
        mark_retraction(hand);
    else if (draft_.task == Task::guide)
        draft_.places.push_back(four_decimals(hand.tool));
    else if (least_places(draft_.task) == 0)
        message_ = shown_text("this task has no marks");
    else if (hand.touched)
        draft_.places.push_back(four_decimals(*hand.touched));
    else
        message_ = shown_text("touch the organ where the mark is to be");
}

void ExerciseEditor::mark_retraction(const HandNow& hand) {
    std::vector<Vector3d>& places = draft_.places;
    if (places.size() == 3)
        message_ = shown_text("rim and place are set; Delete takes the place back");
    else if (places.empty() && hand.rim)
        places = {four_decimals(*hand.rim), four_decimals(hand.tool)};
    else if (places.empty())
        message_ = shown_text("take hold of the rim first");
    else if (is_drawn_to(hand.tool, draft_))
        places.push_back(four_decimals(hand.tool));
    else
        message_ = shown_text("draw it farther, by more than the tolerance");
}

Wish ExerciseEditor::press_on_page(std::string_view key, const HandNow& hand) {
    message_.clear();
    const std::vector<Setting> rows = settings();
    const auto row = static_cast<std::size_t>(std::ranges::find(rows, chosen_) - rows.begin());
    if (key.size() == 1 && std::isdigit(static_cast<unsigned char>(key[0])) != 0 && key[0] != '0') {
        choose(static_cast<std::size_t>(key[0] - '1'));
        typing_ = chosen_ == Setting::title;
    }
    if (key == "down") choose(std::min(row + 1, rows.size() - 1));
    if (key == "up" && row > 0) choose(row - 1);
    if (key == "plus" || key == "equal" || key == "kp_add" || key == "right") change(1);
    if (key == "minus" || key == "kp_subtract" || key == "left") change(-1);
    if (key == "return" && chosen_ == Setting::title) typing_ = true;
    const bool of_force = chosen_ == Setting::least_force || chosen_ == Setting::most_force;
    if (key == "f" && !of_force) message_ = shown_text("first choose one of the forces");
    if (key == "f" && of_force && hand.force <= 0) message_ = shown_text("no force is felt");
    if (key == "f" && of_force && hand.force > 0)
        set_force(stepped(hand.force, second_digit(hand.force), 0, least_settable));
    if (key == "t" && is_complete()) return Wish::attempt;
    if (key == "s" && is_complete()) return Wish::save;
    return key == "backspace" ? Wish::leave : Wish::nothing;
}

void ExerciseEditor::type(std::string_view key) {
    if (key == "Return" || key == "KP_Enter" || key == "Escape") {
        typing_ = false;
    } else if (key == "BackSpace") {
        if (!draft_.title.empty()) draft_.title.pop_back();
    } else if (const char letter = typed_letter(key); letter != '\0' && draft_.title.size() < longest_title) {
        draft_.title += letter;
    }
}

void ExerciseEditor::choose(std::size_t row) {
    const std::vector<Setting> rows = settings();
    if (row < rows.size()) chosen_ = rows[row];
}

void ExerciseEditor::change(int ways) {
    switch (chosen_) {
        case Setting::task:
            return change_task(ways);
        case Setting::title:
            message_ = shown_text("Enter, and type it");
            return;
        case Setting::region:
            return change_region(ways);
        case Setting::least_force:
            return set_force(
                stepped(*draft_.least_force, second_digit(*draft_.least_force), ways, least_settable));
        case Setting::most_force:
            return set_force(
                stepped(*draft_.most_force, second_digit(*draft_.most_force), ways, least_settable));
        case Setting::tolerance:
            draft_.tolerance = stepped(*draft_.tolerance, tolerance_step, ways, tolerance_step);
            return;
        case Setting::hold:
            draft_.hold = stepped(*draft_.hold, hold_step, ways, hold_step);
            return;
        case Setting::time_limit:
            break;
    }
    const double limit = stepped(draft_.time_limit.value_or(0), time_step, ways, 0);
    draft_.time_limit = limit > 0 ? std::optional(limit) : std::nullopt;
}

void ExerciseEditor::change_task(int ways) {
    const bool usual = draft_.instruction == usual_instruction(draft_.task);
    const bool untitled = draft_.title == draft_.name;
    const Task before = std::exchange(draft_.task, turned(choices_.tasks, draft_.task, ways));
    // A rim, where closed tips meet there, and where to draw those are no marks of another task.
    if ((before == Task::retract) != (draft_.task == Task::retract)) draft_.places.clear();
    if (usual) draft_.instruction = usual_instruction(draft_.task);
    if (choices_.taken.empty()) return;
    draft_.name = free_exercise_name(draft_.task, choices_.taken);
    if (untitled) draft_.title = draft_.name;
}

void ExerciseEditor::change_region(int ways) {
    if (choices_.regions.size() == 1) message_ = shown_text("the case hides nothing else");
    // None that is named is the first.
    draft_.region =
        turned(choices_.regions, draft_.region.empty() ? choices_.regions.front() : draft_.region, ways);
}

// Of the one that is chosen.
void ExerciseEditor::set_force(double newtons) {
    std::optional<double>& force = chosen_ == Setting::least_force ? draft_.least_force : draft_.most_force;
    const double before = *std::exchange(force, newtons);
    if (*draft_.least_force < *draft_.most_force) return;
    force = before;
    message_ = shown_text("the least force must stay below the most");
}

bool ExerciseEditor::is_complete() {
    const std::size_t needed = least_places(draft_.task);
    const std::vector<Vector3d>& places = draft_.places;
    if (draft_.task == Task::retract && places.size() == 3 && !is_drawn_to(places[2], draft_)) {
        message_ = shown_text("draw it farther, by more than the tolerance");
        return false;
    }
    if (places.size() >= needed) return true;
    message_ = draft_.task == Task::retract ? shown_text("first hold a rim and draw it: Space, then M twice")
               : needed == 1                ? shown_text("set a mark first: Space, then M")
                                            : shown_text("set two marks or more first: Space, then M");
    return false;
}

}  // namespace palpate::training
