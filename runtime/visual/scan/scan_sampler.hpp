// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vtkImageData.h>
#include <vtkImageMapToColors.h>
#include <vtkImageReslice.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkTexture.h>

#include "runtime/visual/scan/scan_plane.hpp"

namespace palpate::visual {

/// A scan as those who sample it share it.
struct ScanImage {
    explicit ScanImage(const Scan& scan);

    ImageGrid grid;
    GreyWindow window;
    vtkSmartPointer<vtkImageData> voxels;  ///< in mm along the grid's axes, voxel (0, 0, 0) at the origin
    vtkNew<vtkLookupTable> greys;          ///< of the window; transparent where there is no number
};

/// A scan on a plane, as a texture of greys, transparent beyond the scan.
class ScanSampler {
  public:
    explicit ScanSampler(const ScanImage& image);

    /// Samples the plane at so many points, by linear interpolation. Linear in them.
    void sample(const ScanPlane& plane, int columns, int rows);

    vtkTexture* texture() const { return texture_; }
    /// What the texture holds: RGBA, `columns` by `rows`, from the plane's corner on.
    vtkImageData* picture() { return colours_->GetOutput(); }

  private:
    ImageGrid grid_;
    vtkNew<vtkImageReslice> reslice_;
    vtkNew<vtkImageMapToColors> colours_;
    vtkNew<vtkTexture> texture_;
};

}  // namespace palpate::visual
