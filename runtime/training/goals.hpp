// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "runtime/training/exercise.hpp"

namespace palpate::training {

/// What the goals of an exercise see of a tick.
struct Moment {
    double duration = 0;                             ///< s, since the last one
    double force = 0;                                ///< N
    Eigen::Vector3d tool = Eigen::Vector3d::Zero();  ///< p_P, mm
    std::optional<Eigen::Vector3d> touched = {};     ///< of the tissue at rest, p_P, mm
    bool force_is_the_tissues = true;  ///< no fault has taken some of it away, which is no letting go
};

/// How far a trainee has come with the goals of an exercise.
struct Goals {
    double share = 0;           ///< of the goals, 0 to 1
    bool reached_all = false;   ///< nothing is left to do
    std::size_t reached = 0;    ///< places, gates or marks so far
    double line_reached = 0;    ///< trace: mm from its beginning
    double held = 0;            ///< touch: s on the place that is due; retract: at the place drawn to
    double nearest = 0;         ///< guide: mm, how near the tool came to the last gate's middle
    std::size_t misses = 0;     ///< see Metrics
    double squared_errors = 0;  ///< mm^2, summed over error_count
    double errors = 0;          ///< mm, summed over error_count
    std::size_t error_count = 0;

    bool was_touching = false;  ///< at the last moment
    bool was_drawn = false;     ///< retract: tissue was held away from its place
    bool was_astray = false;    ///< beside the mark or the line, or above the force limit
    std::optional<Eigen::Vector3d> last_touched{};
    std::vector<Eigen::Vector3d> border{};  ///< find: where the trainee says that it ends, p_P, mm
};

/// Follows what the tool did for one moment: see Task, and Metrics for errors and misses. Goals that ask for
/// a force wait while a fault takes it away.
void follow(const Exercise& exercise, const Moment& moment, Goals& goals);

/// find: the trainee says that it lies below what he last touched; true within the tolerance, a share that
/// falls linearly to 0 at three times the tolerance. Ends the search. Nothing before the first touch, and in
/// other exercises.
void mark(const Exercise& exercise, Goals& goals);

/// find: the trainee says that the border of what is hidden lies below what he last touched; as often as he
/// likes before the answer. Nothing before the first touch, after the answer, and in other exercises.
void mark_border(const Exercise& exercise, Goals& goals);

/// Mean distance of the border's marks from the outline, mm; not a number without either.
double border_error(const Exercise& exercise, const Goals& goals);

}  // namespace palpate::training
