// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <string>

#include "formats/model/scan.hpp"

namespace palpate::visual {

/// A rectangle in frame P on which a scan is shown.
struct ScanPlane {
    Eigen::Vector3d corner;     ///< lower left, p_P, mm
    Eigen::Vector3d right, up;  ///< unit, at right angles
    double width, height;       ///< mm, along `right` and `up`
};

/// The planes of the patient's body.
enum class SlicePlane { axial, coronal, sagittal };

/// The slice through `p` (p_P, mm) as wide and high as the scan is; where `p` lies beyond the scan, the
/// scan's outermost one on that side.
ScanPlane slice_through(const ImageGrid& grid, SlicePlane plane, const Eigen::Vector3d& p);

/// What a slice is and where: "axial, 22.0 mm superior"; of LPS coordinates below 0 the other side.
std::string slice_text(SlicePlane plane, const ScanPlane& slice);

/// Which values lie between black and white.
struct GreyWindow {
    double black, white;
};

/// A CT's usual window for soft tissue, -160 to 240 HU; otherwise the 1st to the 99th percentile of values.
/// Linear in voxels.
GreyWindow grey_window(const Scan& scan);

}  // namespace palpate::visual
