// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vtkActor.h>
#include <vtkPlaneSource.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "runtime/visual/scan/scan_sampler.hpp"

namespace palpate::visual {

/// The scan's slice through the tool, drawn where it lies; hidden at first. It stays at rest while bodies are
/// pressed, for the scan does not know of it.
class ScanSlices {
  public:
    ScanSlices(const ScanImage& image, vtkRenderer* renderer);

    /// Goes on from none to axial, coronal, sagittal and back to none.
    void turn();
    /// Draws none, whichever is on, until it follows again.
    void hide();
    /// Takes the slice to the tool, p_P, mm.
    void follow(const Eigen::Vector3d& tool);
    /// What is shown and where, slice_text(); empty if nothing is.
    const std::string& text() const { return text_; }

  private:
    ImageGrid grid_;
    ScanSampler sampler_;
    vtkNew<vtkPlaneSource> rectangle_;
    vtkSmartPointer<vtkActor> actor_;
    std::optional<SlicePlane> plane_;
    std::optional<ScanPlane> sampled_;  // of plane_
    std::string text_;
};

}  // namespace palpate::visual
