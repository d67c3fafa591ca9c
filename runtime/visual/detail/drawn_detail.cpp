// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/detail/drawn_detail.hpp"

#include <vtkRenderStepsPass.h>
#include <vtkSSAOPass.h>
#include <vtkTranslucentPass.h>

namespace palpate::visual {
namespace {

vtkSmartPointer<vtkRenderPass> occlusion_pass(double field) {
    constexpr double reach_share = 0.03, bias_share = 0.0015;  // of the field
    vtkNew<vtkRenderStepsPass> steps;
    vtkNew<vtkTranslucentPass> translucent;
    steps->SetTranslucentPass(translucent);
    auto pass = vtkSmartPointer<vtkSSAOPass>::New();
    pass->SetRadius(reach_share * field);
    pass->SetBias(bias_share * field);
    pass->SetKernelSize(64);
    pass->BlurOn();
    pass->SetDelegatePass(steps);
    return pass;
}

}  // namespace

void DrawnDetail::frame_took(double seconds) {
    if (!control_) {
        levels_ = detail_levels(window_->GetSize()[1], is_hardware(window_->ReportCapabilities()));
        control_.emplace(static_cast<int>(levels_.size()));
        draw(levels_.back());
        return;
    }
    if (control_->take(seconds)) draw(levels_[static_cast<std::size_t>(control_->level()) - 1]);
}

void DrawnDetail::draw(const Detail& detail) {
    scene_->draw(detail);
    vtkSmartPointer<vtkRenderPass> pass;
    if (detail.pixel > 1) {
        coarse_pixels_->set_size(detail.pixel);
        pass = coarse_pixels_;
    } else if (detail.occlusion) {
        pass = occlusion_pass(field_);
    }
    if (vtkRenderPass* before = renderer_->GetPass(); before != nullptr && before != pass)
        before->ReleaseGraphicsResources(window_);
    renderer_->SetPass(pass);
}

}  // namespace palpate::visual
