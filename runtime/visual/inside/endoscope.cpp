// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/inside/endoscope.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>
#include <vtkActorCollection.h>
#include <vtkLightCollection.h>
#include <vtkPropCollection.h>

namespace palpate::visual {
namespace {

using Eigen::Vector3d;

constexpr double view_angle = 90;                    // degrees
constexpr double farthest_seen = 400;                // mm
constexpr double turning_time = 0.2;                 // s in which it turns to 63 % of what it is to
constexpr double least_step = 0.2;                   // mm, of a motion that has a direction
constexpr double brightness = 1.4, half_light = 30;  // mm, at which half of it is left
// Of the window: a corner's width, its height at most, and where it begins.
constexpr double corner_width = 0.3, corner_height = 0.5, corner_margin = 0.017, corner_bottom = 0.1;

// Of a direction in a tool's frame what is across its shaft, unit; any where it runs along that.
Vector3d across(const Vector3d& direction) {
    constexpr double least = 0.3;
    const Vector3d aside(direction.x(), direction.y(), 0);
    return aside.norm() < least * direction.norm() ? Vector3d::UnitX() : aside.normalized();
}

void only_light(vtkRenderer* renderer, vtkLight* own, bool on) {
    vtkLightCollection* lights = renderer->GetLights();
    lights->InitTraversal();
    while (vtkLight* light = lights->GetNextItem()) light->SetSwitch(!on);
    if (on)
        renderer->AddLight(own);
    else
        renderer->RemoveLight(own);
    own->SwitchOn();
}

void for_each_actor(vtkRenderer* renderer, const std::function<void(vtkActor*)>& act) {
    vtkActorCollection* actors = renderer->GetActors();
    actors->InitTraversal();
    while (vtkActor* actor = actors->GetNextActor()) act(actor);
}

}  // namespace

Endoscope::Endoscope(vtkRenderWindow* window, vtkRenderer* outside)
    : window_(window), outside_(outside), window_lens_(outside), corner_lens_(corner_) {
    camera_->SetViewAngle(view_angle);
    light_->SetLightTypeToHeadlight();
    light_->PositionalOn();
    light_->SetConeAngle(180);
    light_->SetIntensity(brightness);
    light_->SetAttenuationValues(1, 0, 1 / (half_light * half_light));
    corner_->SetBackground(0, 0, 0);
    corner_->SetActiveCamera(camera_);
    corner_->AddLight(light_);
    corner_lens_.show(true);
}

void Endoscope::turn() {
    if (place_ == Place::nowhere) {
        fill_window();
    } else if (place_ == Place::window) {
        leave_window();
        if (!window_->HasRenderer(corner_)) window_->AddRenderer(corner_);
        corner_->DrawOn();
        place_ = Place::corner;
    } else {
        turn_off();
    }
}

void Endoscope::turn_off() {
    if (place_ == Place::window) leave_window();
    corner_->DrawOff();
    place_ = Place::nowhere;
}

void Endoscope::fill_window() {
    camera_outside_ = outside_->GetActiveCamera();
    forward_ = Vector3d(camera_outside_->GetDirectionOfProjection());
    camera_->SetViewUp(camera_outside_->GetViewUp());
    placed_ = false;
    outside_->SetActiveCamera(camera_);
    only_light(outside_, light_, true);
    window_lens_.show(true);
    background_ = Vector3d(outside_->GetBackground());
    outside_->SetBackground(0, 0, 0);
    place_ = Place::window;
}

void Endoscope::leave_window() {
    outside_->SetActiveCamera(camera_outside_);
    only_light(outside_, light_, false);
    window_lens_.show(false);
    outside_->SetBackground(background_.data());
}

bool Endoscope::covers(int x, int y) const {
    if (place_ == Place::nowhere) return false;
    if (place_ == Place::window) return true;
    const int* origin = corner_->GetOrigin();
    const int* size = corner_->GetSize();
    return x >= origin[0] && x < origin[0] + size[0] && y >= origin[1] && y < origin[1] + size[1];
}

void Endoscope::look_along(const ScopePose& pose, double seconds) {
    const bool turns = !pose.orientation.coeffs().isZero(0), first = !placed_;
    if (first) {
        tip_ = pose.tip;
        up_in_tool_ = across(pose.orientation.conjugate() * Vector3d(camera_->GetViewUp()));
    }
    placed_ = true;
    if (turns) camera_->SetViewUp(Vector3d(pose.orientation * up_in_tool_).data());
    Vector3d way = pose.tip - tip_;
    // What is drawn back goes on looking ahead.
    if (way.dot(forward_) < 0) {
        tip_ = pose.tip;
        way.setZero();
    }
    if (pose.look_at) way = *pose.look_at - pose.tip;
    if (!pose.shaft.isZero()) way = -pose.shaft;
    if (way.norm() < least_step) return;
    // By the angle, so that it turns right round too.
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(forward_, way);
    const double part = first ? 1 : 1 - std::exp(-seconds / turning_time);
    forward_ = (Eigen::Quaterniond::Identity().slerp(part, turn) * forward_).normalized();
    tip_ = pose.tip;
}

void Endoscope::fit_corner() {
    const int* size = window_->GetSize();
    const double side = std::min(corner_width * size[0], corner_height * size[1]);
    const double right = 1 - corner_margin, top = corner_bottom + side / size[1];
    corner_->SetViewport(right - side / size[0], corner_bottom, right, top);
}

// The same actors in another renderer, but those that the eye is in. Whatever leaves a renderer loses what it
// has on the graphics card, so only what the scene has lost leaves this one.
void Endoscope::share_scene(std::span<vtkActor* const> hidden) {
    const vtkMTimeType changed = outside_->GetViewProps()->GetMTime();
    if (changed == shared_) return;
    shared_ = changed;
    std::vector<vtkActor*> lost;
    for_each_actor(corner_, [&](vtkActor* actor) {
        if (!outside_->HasViewProp(actor)) lost.push_back(actor);
    });
    for (vtkActor* actor : lost) corner_->RemoveActor(actor);
    for_each_actor(outside_, [&](vtkActor* actor) {
        if (std::ranges::find(hidden, actor) == hidden.end()) corner_->AddActor(actor);
    });
}

void Endoscope::follow(const ScopePose& pose, double tool_radius, double seconds,
                       std::span<vtkActor* const> hidden) {
    if (!on()) return;
    look_along(pose, seconds);
    const Vector3d ahead = pose.tip + forward_;
    camera_->SetPosition(pose.tip.data());
    camera_->SetFocalPoint(ahead.data());
    camera_->OrthogonalizeViewUp();
    camera_->SetClippingRange(0.3 * tool_radius, farthest_seen);
    if (place_ == Place::window) return window_lens_.fit();
    fit_corner();
    share_scene(hidden);
    corner_lens_.fit();
}

}  // namespace palpate::visual
