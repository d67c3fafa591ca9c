// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "runtime/training/exercise.hpp"
#include "runtime/training/exercise_file.hpp"

namespace palpate::training {

/// What the hand does while a key is pressed.
struct HandNow {
    Eigen::Vector3d tool = Eigen::Vector3d::Zero();  ///< p_P, mm
    double force = 0;                                ///< N
    std::optional<Eigen::Vector3d> touched{};        ///< of the tissue at rest, p_P, mm
    std::optional<Eigen::Vector3d> rim{};            ///< over a forceps' tips that hold tissue, p_P, mm
};

/// What a teacher may choose from.
struct Choices {
    std::vector<Task> tasks;           ///< at least one
    std::vector<std::string> regions;  ///< that the case hides
    /// Names that a new draft must not get; none: the draft keeps its own, so that it takes the place of what
    /// it was made from.
    std::vector<std::string> taken{};
};

/// The tasks that a hand with the case's tool is given, or one with a forceps.
std::vector<Task> tasks_of(bool with_forceps);

/// What of an exercise is set on the editor's page.
enum class Setting { task, title, region, least_force, most_force, tolerance, hold, time_limit };

/// What a key asks of whoever holds the editor.
enum class Wish {
    nothing,
    attempt,  ///< to try the exercise
    save,     ///< to write it into the file
    leave,    ///< to leave it, unsaved
};

/// The letter that a key types, by its X11 name ("a", "A", "minus"); 0: none.
char typed_letter(std::string_view key);

/// "touch-1", or the first higher number that is not taken.
std::string free_exercise_name(Task task, std::span<const std::string> taken);

/// The recipe of an exercise with everything in it that was found on the patient: forces, tolerance, hold and
/// places.
ExerciseRecipe settled(ExerciseRecipe recipe, const Exercise& exercise);

/// A teacher's draft of an exercise, and what keys make of it. Keys are X11 names. On the page a digit or
/// up and down choose a setting, + and - or right and left change it, "f" takes the force that is felt now,
/// "Return" or its digit begins to type the title, "t" tries, "s" saves, "BackSpace" leaves. "space" leads to
/// the organ and back; there "m" sets a mark at the touched tissue (guide: a gate at the tool's tip; retract:
/// first the rim that is held, then where it is drawn) and "Delete" takes the last one back. Forces go by two
/// digits, tolerances by half a millimetre, times by a tenth of a second or by ten. What is set has four
/// decimals at most.
class ExerciseEditor {
  public:
    /// A draft that is settled().
    ExerciseEditor(ExerciseRecipe draft, Choices choices);

    Wish press(std::string_view key, const HandNow& hand);

    /// The draft, without what its task does not know.
    ExerciseRecipe recipe() const;
    /// The settings of its task, in the order of the page.
    std::vector<Setting> settings() const;
    Setting chosen() const { return chosen_; }
    bool page_shown() const { return page_shown_; }
    bool typing() const { return typing_; }
    /// What the last key did, or why it could not; empty: nothing to say.
    const std::string& message() const { return message_; }
    void tell(std::string message) { message_ = std::move(message); }

  private:
    void press_on_organ(std::string_view key, const HandNow& hand);
    Wish press_on_page(std::string_view key, const HandNow& hand);
    void type(std::string_view key);
    void mark(const HandNow& hand);
    void mark_retraction(const HandNow& hand);
    void take_mark_back();
    void choose(std::size_t row);
    void change(int ways);
    void change_task(int ways);
    void change_region(int ways);
    void set_force(double newtons);
    bool is_complete();

    ExerciseRecipe draft_;
    Choices choices_;
    Setting chosen_ = Setting::task;
    bool page_shown_ = true, typing_ = false;
    std::string message_;
};

}  // namespace palpate::training
