// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/scan/scan_sampler.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <vtkMatrix4x4.h>

namespace palpate::visual {

using Eigen::Vector3d;

ScanImage::ScanImage(const Scan& scan)
    : grid(scan.grid), window(grey_window(scan)), voxels(vtkSmartPointer<vtkImageData>::New()) {
    voxels->SetDimensions(grid.size.data());
    voxels->SetSpacing(grid.spacing.data());
    voxels->AllocateScalars(VTK_SHORT, 1);
    std::ranges::copy(scan.values, static_cast<std::int16_t*>(voxels->GetScalarPointer()));
    greys->SetRange(window.black, window.white);
    greys->SetHueRange(0, 0);
    greys->SetSaturationRange(0, 0);
    greys->SetValueRange(0, 1);
    greys->SetRampToLinear();
    greys->SetNanColor(0, 0, 0, 0);
    greys->Build();
}

ScanSampler::ScanSampler(const ScanImage& image) : grid_(image.grid) {
    // What lies beyond the scan is no number.
    constexpr double beyond = std::numeric_limits<double>::quiet_NaN();
    reslice_->SetInputData(image.voxels);
    reslice_->SetInterpolationModeToLinear();
    reslice_->SetOutputDimensionality(2);
    reslice_->SetOutputExtent(0, 0, 0, 0, 0, 0);  // until a plane is asked for
    reslice_->SetOutputScalarType(VTK_FLOAT);
    reslice_->SetBackgroundColor(beyond, beyond, beyond, beyond);
    colours_->SetLookupTable(image.greys);
    colours_->SetOutputFormatToRGBA();
    colours_->SetInputConnection(reslice_->GetOutputPort());
    texture_->SetInputConnection(colours_->GetOutputPort());
    texture_->SetColorModeToDirectScalars();
    texture_->InterpolateOn();
    texture_->RepeatOff();
    texture_->EdgeClampOn();
}

void ScanSampler::sample(const ScanPlane& plane, int columns, int rows) {
    const Eigen::Matrix3d to_grid = grid_.direction.transpose();
    const Vector3d right = to_grid * plane.right, up = to_grid * plane.up, across = right.cross(up),
                   corner = to_grid * (plane.corner - grid_.origin);
    vtkNew<vtkMatrix4x4> axes;
    for (int row = 0; row < 3; ++row) {
        axes->SetElement(row, 0, right[row]);
        axes->SetElement(row, 1, up[row]);
        axes->SetElement(row, 2, across[row]);
        axes->SetElement(row, 3, corner[row]);
    }
    const double dx = plane.width / columns, dy = plane.height / rows;
    reslice_->SetResliceAxes(axes);
    reslice_->SetOutputSpacing(dx, dy, 1);
    reslice_->SetOutputOrigin(dx / 2, dy / 2, 0);  // samples lie in the middle of texels
    reslice_->SetOutputExtent(0, columns - 1, 0, rows - 1, 0, 0);
    colours_->Update();
}

}  // namespace palpate::visual
