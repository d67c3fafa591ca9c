// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/scan_view.hpp"

#include <vtkTextProperty.h>

#include "runtime/visual/overlay.hpp"
#include "runtime/visual/screen_text.hpp"

namespace palpate::visual {
namespace {

constexpr double right_edge = 0.908;  // of the window: where its scale begins

}  // namespace

ScanView::ScanView(const Scan& scan, std::span<vtkActor* const> bodies, vtkRenderer* renderer,
                   vtkRenderer* front)
    : renderer_(renderer),
      front_(front),
      image_(scan),
      slices_(image_, renderer),
      faces_(image_),
      scale_(image_.greys, scan.hounsfield ? "HU" : "", right_edge, front) {
    for (vtkActor* body : bodies) faces_.paint(body);
    text_->GetTextProperty()->SetJustificationToCentered();
    text_->GetTextProperty()->SetVerticalJustificationToTop();
    dress(text_->GetTextProperty(), 0.55);
    text_->VisibilityOff();
    front->AddActor2D(text_);
}

void ScanView::follow(const Eigen::Vector3d& tool, bool cut) {
    slices_.follow(tool);
    faces_.follow(renderer_, cut);
    tell(cut);
}

void ScanView::hide() {
    slices_.hide();
    faces_.follow(renderer_, false);
    tell(false);
}

void ScanView::tell(bool cut) {
    scale_.show(cut || shows_slice());
    scale_.fit();
    text_->SetVisibility(shows_slice());
    if (!shows_slice()) return;
    constexpr double font_size = 16;  // points in a window of 1280x720
    const int* size = front_->GetSize();
    text_->SetInput((" " + slices_.text() + " ").c_str());
    text_->GetTextProperty()->SetFontSize(static_cast<int>(font_size * display_scale(size[0], size[1])));
    text_->SetPosition(0.5 * size[0], 0.975 * size[1]);
}

}  // namespace palpate::visual
