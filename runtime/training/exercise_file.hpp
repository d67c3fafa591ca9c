// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runtime/training/exercise.hpp"

namespace palpate::training {

/// An exercise as a person writes it; what is absent is found on the patient, see lay_out().
struct ExerciseRecipe {
    std::string name, title, instruction;
    Task task = Task::free;
    std::optional<double> time_limit, least_force, most_force, tolerance, hold;  ///< s, N, N, mm, s
    std::vector<Eigen::Vector3d> places;  ///< p_P, mm; empty: drawn or found on the patient
    std::int64_t count = 5;               ///< touch: how many places are drawn
    std::uint64_t seed = 1;               ///< touch: of the draw
    double spread = 40;      ///< mm from the start: touch: places are drawn within; trace: half the line
    std::string region;      ///< find: empty: the first that another encloses
    std::string written_at;  ///< "exercises.toml:12"

    bool operator==(const ExerciseRecipe&) const = default;
};

/// Reads `[[exercise]]` tables of a TOML file with `schema = 1`. Throws InvalidInput naming file, line and
/// key for what cannot be, among it two exercises of one name and a file without any.
std::vector<ExerciseRecipe> read_exercises(const std::filesystem::path& file);

/// What a trainee reads who is given a task and no other words.
std::string usual_instruction(Task task);

/// The exercises that every patient offers, to a hand with the case's tool or with a forceps, in the order of
/// the start page.
std::vector<ExerciseRecipe> standard_exercises(bool with_forceps);

}  // namespace palpate::training
