// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/hand/steering.hpp"

#include <map>

#include "runtime/visual/hand/view_control.hpp"

namespace palpate::visual {
namespace {

using Eigen::Vector3d;

constexpr double key_step = 0.5;             // mm
constexpr double shaft_step = 0.5;           // mm a notch, along a forceps' shaft
constexpr double tip_step = 1;               // mm a notch, seen from the tip
constexpr double tip_sight = 15, leash = 3;  // mm: see drag_hand(); that a hand goes ahead of its tip

// A hand that sees from the tip sees where that is held up, and does not push on and on.
void move(const Steering& steering, const Vector3d& by) {
    steering.hand.move(by);
    if (!steering.tip) return;
    const Vector3d ahead = steering.hand.place() - *steering.tip;
    if (ahead.norm() > leash) steering.hand.put(*steering.tip + leash * ahead.normalized());
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

}  // namespace palpate::visual
