// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/hand/steering.hpp"

#include <map>
#include <numbers>

#include "formats/model/geometry/rotations.hpp"
#include "runtime/visual/hand/view_control.hpp"

namespace palpate::visual {
namespace {

using Eigen::Vector3d;

constexpr double key_step = 0.5;                              // mm
constexpr double shaft_step = 0.5;                            // mm a notch, along a forceps' shaft
constexpr double tip_step = 1;                                // mm a notch, seen from the tip
constexpr double tilt_step = 5 * std::numbers::pi / 180;      // rad a key press
constexpr double tilt_pixel = 0.35 * std::numbers::pi / 180;  // rad
constexpr double tip_sight = 15, leash = 3;  // mm: see drag_hand(); that a hand goes ahead of its tip

// A hand that sees from the tip sees where that is held up, and does not push on and on.
void move(const Steering& steering, const Vector3d& by) {
    steering.hand.move(by);
    if (!steering.tip) return;
    const Vector3d ahead = steering.hand.place() - *steering.tip;
    if (ahead.norm() > leash) steering.hand.put(*steering.tip + leash * ahead.normalized());
}

// By a rotation vector in frame P.
void turn(const Steering& steering, const Vector3d& by) {
    if (steering.orientation != nullptr) *steering.orientation = turned(*steering.orientation, by);
}

// The way back out, unit.
Vector3d back(const Steering& steering) {
    return steering.shaft ? *steering.shaft : view_axes(steering.camera)[2];
}

}  // namespace

void drag_hand(const Steering& steering, double dx, double dy) {
    const double depth = steering.tip ? tip_sight : depth_of(steering.camera, steering.hand.place());
    move(steering, way_of_drag(steering.camera, dx, dy, depth, steering.window_height));
}

void roll_hand(const Steering& steering, double notches) {
    move(steering, -(steering.tip ? tip_step : shaft_step) * notches * back(steering));
}

void step_hand(const Steering& steering, const std::string& key) {
    const auto [right, up, eye] = view_axes(steering.camera);
    const Vector3d out = back(steering);
    const std::map<std::string, Vector3d> ways{{"Left", -right}, {"Right", right}, {"Up", up},
                                               {"Down", -up},    {"w", -out},      {"s", out}};
    if (const auto way = ways.find(key); way != ways.end()) move(steering, key_step * way->second);
}

void tilt_tool(const Steering& steering, double dx, double dy) {
    const auto [right, up, eye] = view_axes(steering.camera);
    // What the tip sees goes as its handle does: towards the pointer.
    turn(steering, tilt_pixel * Vector3d(dx * up - dy * right));
}

void tilt_tool(const Steering& steering, const std::string& key) {
    if (steering.orientation == nullptr) return;
    const auto [right, up, eye] = view_axes(steering.camera);
    const Vector3d shaft = *steering.orientation * Vector3d::UnitZ();
    const double side = steering.tip ? -1 : 1;  // what looks to the right has its handle go to the left
    const std::map<std::string, Vector3d> turns{{"Left", -side * up},  {"Right", side * up},
                                                {"Up", -side * right}, {"Down", side * right},
                                                {"w", shaft},          {"s", -shaft}};
    if (const auto about = turns.find(key); about != turns.end()) turn(steering, tilt_step * about->second);
}

}  // namespace palpate::visual
