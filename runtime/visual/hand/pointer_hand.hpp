// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "runtime/visual/hand/surface_under.hpp"

namespace palpate::visual {

/// What the pointer's hand asks of the scene.
struct PointerScene {
    /// The surface under a pixel of the window.
    std::function<std::optional<SeenPoint>(const Eigen::Vector2d& pixel)> under;
    /// Whether something is in the tool's way between two places, p_P, mm.
    std::function<bool(const Eigen::Vector3d& from, const Eigen::Vector3d& to)> blocked;
};

/// The hand as the mouse holds it: it hovers over the surface under the pointer; while the button is held it
/// sinks to a depth below that surface, along its inward normal, and slides where the pointer is dragged;
/// where a force is wanted it sinks until that is felt, three times as deep at most, and keeps the depth. It
/// never jumps: it goes over the surface between two pixels, and where that ends, to what the pointer rests
/// on behind the edge, around what stands in its way, towards the eye; where there is no such way it stays.
class PointerHand {
  public:
    static constexpr double hover = 2;                           ///< mm, of the tool over the surface
    static constexpr double least_depth = 0.5, most_depth = 40;  ///< mm

    /// `start`: of the tool's centre, p_P, mm. `tool_radius`: mm.
    PointerHand(const Eigen::Vector3d& start, double tool_radius);

    const Eigen::Vector3d& place() const { return place_; }  ///< of the tool's centre, p_P, mm
    /// To which a press goes, mm, where no force is wanted.
    double depth() const { return depth_; }
    bool pressing() const { return pressed_; }

    /// The pointer moved to a pixel, which takes the hand there.
    void point(const Eigen::Vector2d& pixel);
    void press(bool on);
    /// Changes how deep a press goes, mm; where a force is wanted that of this press alone, which then goes
    /// no further by itself.
    void deepen(double by);
    /// What the tool feels now, and what a press is to make; without that, a press goes to depth(). N.
    void feel(double force, const std::optional<double>& wanted);
    /// Takes the hand off the surface (mm), until the pointer moves again.
    void move(const Eigen::Vector3d& by);
    /// Puts it at a place of its own, p_P, mm.
    void put(const Eigen::Vector3d& place);
    /// The view has changed: what is under the pointer now does not count until it moves again.
    void view_changed();
    /// Goes on for so long, s.
    void advance(double seconds, const PointerScene& scene);

  private:
    Eigen::Vector3d goal() const;
    void sink(double seconds);
    void seek_next_pixel(const PointerScene& scene);
    bool go_around(const SeenPoint& next, const PointerScene& scene);

    double radius_, depth_;
    Eigen::Vector3d place_;
    double offset_ = hover;  // of the tool's surface over the rest surface, mm
    bool led_ = false;       // by the pointer, not by keys
    bool seeking_ = false;   // what is under it, which a new view leaves until it moves again
    bool pressed_ = false;
    double force_ = 0;                   // N
    std::optional<double> wanted_;       // N
    std::optional<double> found_depth_;  // mm, of this press: where it felt what is wanted
    double rested_ = 0;                  // s, the pointer
    Eigen::Vector2d pointer_ = Eigen::Vector2d::Zero();
    std::optional<Eigen::Vector2d> reached_;  // the pixel of anchor_ or of nothing
    std::optional<SeenPoint> anchor_;
    bool found_ = false;                   // anchor_ at the last pixel
    std::vector<Eigen::Vector3d> detour_;  // places before the goal, the last one first
};

}  // namespace palpate::visual
