// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/scan/scan_slices.hpp"

#include <algorithm>
#include <cmath>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

namespace palpate::visual {
namespace {

// As fine as the scan, as far as a screen shows it.
int samples_along(double length, const ImageGrid& grid) {
    constexpr int fewest = 16, most = 512;
    return std::clamp(static_cast<int>(std::ceil(length / grid.spacing.minCoeff())), fewest, most);
}

}  // namespace

ScanSlices::ScanSlices(const ScanImage& image, vtkRenderer* renderer)
    : grid_(image.grid), sampler_(image), actor_(vtkSmartPointer<vtkActor>::New()) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(rectangle_->GetOutputPort());
    actor_->SetMapper(mapper);
    actor_->SetTexture(sampler_.texture());
    actor_->GetProperty()->LightingOff();
    actor_->ForceOpaqueOn();  // what is beyond the scan is left out, and nothing lets through
    actor_->VisibilityOff();
    renderer->AddActor(actor_);
}

void ScanSlices::turn() {
    if (!plane_)
        plane_ = SlicePlane::axial;
    else if (*plane_ == SlicePlane::sagittal)
        plane_.reset();
    else
        plane_ = static_cast<SlicePlane>(static_cast<int>(*plane_) + 1);
    sampled_.reset();
}

void ScanSlices::hide() {
    actor_->VisibilityOff();
    text_.clear();
    sampled_.reset();
}

void ScanSlices::follow(const Eigen::Vector3d& tool) {
    if (!plane_) return hide();
    actor_->VisibilityOn();
    const ScanPlane slice = slice_through(grid_, *plane_, tool);
    const double seen = 0.1 * grid_.spacing.minCoeff();
    if (sampled_ && (sampled_->corner - slice.corner).norm() < seen) return;
    sampled_ = slice;
    text_ = slice_text(*plane_, slice);
    sampler_.sample(slice, samples_along(slice.width, grid_), samples_along(slice.height, grid_));
    const Eigen::Vector3d right = slice.corner + slice.width * slice.right,
                          up = slice.corner + slice.height * slice.up;
    rectangle_->SetOrigin(slice.corner.x(), slice.corner.y(), slice.corner.z());
    rectangle_->SetPoint1(right.x(), right.y(), right.z());
    rectangle_->SetPoint2(up.x(), up.y(), up.z());
}

}  // namespace palpate::visual
