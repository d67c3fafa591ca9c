// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vtkCamera.h>

#include "runtime/visual/hand/pointer_hand.hpp"

namespace palpate::visual {

/// How mouse and keys take a hand through space, not over a surface.
struct Steering {
    PointerHand& hand;
    vtkCamera* camera;  ///< of the picture
    int window_height;  ///< pixels
    /// Out along its shaft, unit, of a forceps that is held.
    std::optional<Eigen::Vector3d> shaft;
    /// Where the picture is seen from, p_P, mm, if that is the tool's tip.
    std::optional<Eigen::Vector3d> tip;
    /// How a tool that turns is held, R_PT; null: mouse and keys turn none.
    Eigen::Quaterniond* orientation = nullptr;
};

/// A drag by so many pixels: in the picture's plane, as far as what lies as deep goes with the pointer, which
/// is the hand or, seen from the tip, 15 mm before that.
void drag_hand(const Steering& steering, double dx, double dy);
/// The wheel: into the picture, seen from the tip; else a forceps along its shaft.
void roll_hand(const Steering& steering, double notches);
/// An arrow key, "w" or "s", half a millimetre: sideways, in and out, along the shaft of a forceps.
void step_hand(const Steering& steering, const std::string& key);

/// Turns a tool about its tip, by a drag of so many pixels: its handle goes with the pointer; seen from the
/// tip, what is seen does.
void tilt_tool(const Steering& steering, double dx, double dy);
/// The same by an arrow key, 5 degrees to its side; seen from the tip, it looks there. "w" or "s" roll it
/// about its shaft.
void tilt_tool(const Steering& steering, const std::string& key);

}  // namespace palpate::visual
