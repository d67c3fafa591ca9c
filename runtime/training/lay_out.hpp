// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/devices/hand_path.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/session/touch_target.hpp"
#include "runtime/training/exercise.hpp"
#include "runtime/training/exercise_file.hpp"

namespace palpate::training {

/// An enclosed region of a deformable body and where it is to be felt.
struct HiddenRegion {
    std::string name;
    std::size_t body = 0;    ///< as in HapticModel
    std::int32_t label = 0;  ///< of its tetrahedra
    Eigen::Vector3d above;   ///< on the surface straight above its middle, where it is felt; p_P, mm
    double depth = 0;        ///< mm, from there to the nearest node of it
};

/// The regions of deformable bodies that are not a body's largest, by name. Each is above on the side of the
/// surface vertex that feels it most, see place_above(); where a case does not say what can be felt, the free
/// vertex nearest to the region's middle stands for that.
std::vector<HiddenRegion> hidden_regions(const Case& patient_case);

/// Where a hand starts so that there is something to feel: 7 to 16 % of the body's extent beside the first
/// hidden region's place, on its side of the body and straight in reach of it; drawn by `seed`. Above the
/// region itself where no such place is found; without a hidden region, or where the tool does not fit there,
/// as choose_touch_target(). Throws as that.
session::TouchTarget choose_start(const Case& patient_case, const haptics::HapticModel& model,
                                  const std::string& body_name, std::uint64_t seed);

/// From where a patient is looked at first.
struct FirstEye {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< p_P, mm
    bool cuts = false;                                ///< what stands before is cut away
};

/// Lays an exercise out on a patient, around the place where the hand starts. What the recipe leaves open:
/// marks are drawn within `spread` of the start on the side that is seen from above it, at places that the
/// tool reaches and, if enough are, that the eye sees; a line, likewise, goes along the surface, through the
/// start or, where it would be shorter than `spread`, near it; the least force is what the tool makes 1 mm
/// deep there, the most 4 mm deep (no more than four fifths of what the case allows); tolerances are one and
/// a half tool radii, 2 mm at least, 10 mm where something is to be found; tissue is drawn back by 5 mm out
/// of the rim at the start, within 2 mm and with no more than 1 N. Nothing for a search in a case that hides
/// nothing. Throws InvalidInput naming the recipe for a region that the case has not, or a surface on which
/// the marks or the line find no room. Presses with the model, which it resets: not beside a running tick.
std::optional<Exercise> lay_out(const ExerciseRecipe& recipe, const Case& patient_case,
                                haptics::HapticModel& model, const session::TouchTarget& start,
                                const FirstEye& eye);

/// Lays out a recipe that leaves nothing open: forces are given, and places where its task has any. Nothing
/// for a search in a case that hides nothing. Between two written points of a line others are put, a
/// millimetre apart, on the surface that is nearest to them. Throws as lay_out(). Reads the model's rest
/// surfaces only: beside a running tick too.
std::optional<Exercise> lay_out_settled(const ExerciseRecipe& recipe, const Case& patient_case,
                                        const haptics::HapticModel& model);

/// The force (N) with which a place answers a tool whose surface is held `depth` mm below it. Resets the
/// model.
double force_at_depth(haptics::HapticModel& model, const devices::TouchPoint& place, double depth);

}  // namespace palpate::training
