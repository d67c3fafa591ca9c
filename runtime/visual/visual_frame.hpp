// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runtime/visual/lesson/lesson_view.hpp"
#include "runtime/visual/playback/playback_view.hpp"
#include "runtime/visual/tools/other_tool.hpp"

namespace palpate::visual {

/// What the window shows at one moment, taken from the haptic thread's latest tick.
struct VisualFrame {
    Eigen::Vector3d device_position = Eigen::Vector3d::Zero();  ///< p_P, mm
    Eigen::Vector3d tool_position = Eigen::Vector3d::Zero();    ///< p_P, mm
    Eigen::Vector3d shaft = Eigen::Vector3d::Zero();   ///< unit, from the tip along the tool; zero: not known
    Eigen::Quaterniond tool_orientation{0, 0, 0, 0};   ///< R_PT where the tool turns by itself; else zero
    Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< on the device, frame P, N
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< of a tool that turns, frame P, N mm
    Eigen::Vector2d force_range = Eigen::Vector2d::Zero();  ///< N: least and most since the last frame
    double depth = 0;                                       ///< below the rest surface, mm
    std::string device;                                     ///< by its own name
    double tick_rate_hz = 0;
    std::int64_t overruns = 0;
    std::uint32_t faults = 0;                ///< Fault flags: why there is no force
    std::uint32_t statuses = 0;              ///< TickStatus flags: what was unusual just now
    bool recording = false;                  ///< every tick is being kept
    bool audible = false;                    ///< the force is heard
    std::optional<bool> jaws_closed;         ///< told to be, of a forceps; nothing: none is held
    std::vector<std::string> deforming_far;  ///< names of bodies whose tissue is solved for large deformation
    /// Of every surface vertex of every deformable body, mm.
    std::vector<std::vector<Eigen::Vector3f>> displacements;
    LessonView lesson;                     ///< of an exercise
    std::vector<OtherTool> other_tools;    ///< beside the held one
    std::optional<TimelineView> timeline;  ///< of a recording that is looked at
    /// Pictures a second of a film that keeps this one: what serves a user alone is left out, texts are not
    /// held back.
    std::optional<double> film_rate_hz;
};

/// Whether the tool turns by itself, as an instrument does.
inline bool turns(const VisualFrame& frame) {
    return !frame.tool_orientation.coeffs().isZero(0);
}

/// Which way the tool's shaft goes from its tip, as it is drawn: its own where it turns, else its device's;
/// unit, zero where neither is known.
inline Eigen::Vector3d shaft_of(const VisualFrame& frame) {
    return turns(frame) ? frame.tool_orientation * Eigen::Vector3d::UnitZ() : frame.shaft;
}

}  // namespace palpate::visual
