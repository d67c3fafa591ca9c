// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "formats/records/shown_text.hpp"

namespace palpate::training {

/// What a trainee is to do.
enum class Task {
    touch,    ///< press every place in turn, and hold
    find,     ///< mark where the surface lies above a hidden region
    guide,    ///< lead the tool through every gate in turn
    trace,    ///< follow a line on the surface while pressing
    free,     ///< whatever he likes
    retract,  ///< take hold of tissue with a forceps, draw it to a place, keep it there and let it go
};

/// "touch", "find", "guide", "trace", "free", "retract", in their order.
inline constexpr std::string_view task_names[] = {shown_text("touch"), shown_text("find"),
                                                  shown_text("guide"), shown_text("trace"),
                                                  shown_text("free"),  shown_text("retract")};

inline constexpr std::string_view name_of(Task task) {
    return task_names[static_cast<std::size_t>(task)];
}

/// An exercise as it lies on one patient.
struct Exercise {
    std::string name;         ///< in files: letters, digits, '-'
    std::string title;        ///< for people
    std::string instruction;  ///< a sentence or two, for people
    Task task = Task::free;
    double time_limit = 0;   ///< s; 0: none
    double least_force = 0;  ///< N; less does not count as touching
    double most_force = 0;   ///< N; more hurts
    double tolerance = 0;    ///< mm, to either side of a place, a gate or a line
    double hold = 0;         ///< touch: s that a place is to be pressed; retract: that tissue is kept drawn
    /// touch: the places, in their order; find: the one above the region; guide: the gates; trace: points of
    /// the line, densely; retract: the rim to take hold of, where closed tips meet there, and where to draw
    /// those. On the rest surface but for gates and tips. p_P, mm.
    std::vector<Eigen::Vector3d> places;
    std::string region;  ///< find: what is hidden
    /// find: its outline on the rest surface, see region_outline(). p_P, mm.
    std::vector<Eigen::Vector3d> outline = {};
};

/// Length of the line through the points, mm.
double length_of(const std::vector<Eigen::Vector3d>& points);

/// The point so far (mm) along that line; its end beyond it. At least one point.
Eigen::Vector3d point_along(const std::vector<Eigen::Vector3d>& points, double distance);

/// A point of a line through points, with straight pieces between them.
struct LinePoint {
    double along = 0;     ///< mm from the line's beginning
    double distance = 0;  ///< mm
};

/// The point of that line between `from` and `to` (mm along it) that is nearest to `p`.
LinePoint nearest_on_line(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& p, double from,
                          double to);

/// The point of that line so far (mm) ahead of the one nearest to `p`, towards the point of index `due`, but
/// not beyond that. `due` is one of `points` (unchecked).
Eigen::Vector3d point_ahead(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& p,
                            std::size_t due, double distance);

}  // namespace palpate::training
