// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/detail/drawn_detail.hpp"

namespace palpate::visual {

void DrawnDetail::frame_took(double seconds) {
    if (!control_) {
        levels_ = detail_levels(window_->GetSize()[1], drawn_by_hardware(window_));
        control_.emplace(static_cast<int>(levels_.size()));
        use(levels_.back());
        return;
    }
    if (control_->take(seconds)) use(affordable());
}

void DrawnDetail::with_everything(const std::function<void()>& work) {
    if (control_) use(levels_.back());
    window_->Render();
    work();
    if (control_) use(affordable());
}

const Detail& DrawnDetail::affordable() const {
    return levels_[static_cast<std::size_t>(control_->level()) - 1];
}

void DrawnDetail::use(const Detail& detail) {
    scene_->draw(detail);
    vtkSmartPointer<vtkRenderPass> pass;
    if (detail.pixel > 1) {
        coarse_pixels_->set(detail.pixel, detail.smooth);
        pass = coarse_pixels_;
    }
    if (detail.occlusion) {
        if (!occlusion_) occlusion_ = occlusion_pass(renderer_);
        pass = occlusion_;
    }
    if (vtkRenderPass* before = renderer_->GetPass(); before != nullptr && before != pass)
        before->ReleaseGraphicsResources(window_);
    renderer_->SetPass(pass);
}

}  // namespace palpate::visual
