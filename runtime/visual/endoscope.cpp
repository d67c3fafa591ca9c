// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/endoscope.hpp"

namespace palpate::visual {
namespace {

using Eigen::Vector3d;

constexpr double view_angle = 90;   // degrees
constexpr double farthest = 400;    // mm
constexpr double agility = 0.15;    // part of the turn that a frame makes
constexpr double least_step = 0.2;  // mm, of a motion that has a direction

}  // namespace

void Endoscope::turn(vtkCamera* camera) {
    on_ = !on_;
    if (!on_) {
        camera->DeepCopy(before_);
        return;
    }
    before_->DeepCopy(camera);
    forward_ = Vector3d(camera->GetDirectionOfProjection());
    placed_ = false;
}

void Endoscope::follow(const Vector3d& tip, const std::optional<Vector3d>& look_at, double tool_radius,
                       vtkCamera* camera) {
    if (!placed_) tip_ = tip;
    placed_ = true;
    const Vector3d way = look_at ? Vector3d(*look_at - tip) : Vector3d(tip - tip_);
    if (way.norm() >= least_step) {
        forward_ = (forward_ + agility * (way.normalized() - forward_)).normalized();
        tip_ = tip;
    }
    const Vector3d ahead = tip + forward_;
    camera->SetPosition(tip.data());
    camera->SetFocalPoint(ahead.data());
    camera->SetViewAngle(view_angle);
    camera->OrthogonalizeViewUp();
    camera->SetClippingRange(0.3 * tool_radius, farthest);
}

}  // namespace palpate::visual
