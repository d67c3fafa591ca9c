// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <string>
#include <string_view>

namespace palpate::draft {

/// What a structure is to a surgeon's tool.
enum class Part {
    organ,   ///< gives way
    lesion,  ///< gives way otherwise, within an organ
    vessel,  ///< belongs to what it runs through
    bone,    ///< does not give way
    aside,   ///< lungs, muscles, skin: no neighbour that a tool would meet
};

/// What a structure's name tells of it.
struct Anatomy {
    Part part = Part::organ;
    std::string tissue;            ///< a preset; empty: none is known
    Eigen::Vector3d held_towards;  ///< unit, LPS: the side by which it is held
    std::string why_held;          ///< one clause
};

/// Reads a name as TotalSegmentator, 3D Slicer's tables and atlases write them, without regard to case. What
/// is not known is an organ held by the side away from `approach` (unit, LPS, from tissue to the surgeon).
Anatomy anatomy_of(std::string_view name, const Eigen::Vector3d& approach);

/// The direction of "anterior", "left" ...; throws UsageError for another word.
Eigen::Vector3d direction_of(const std::string& word, const std::string& option);

}  // namespace palpate::draft
