// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "formats/model/body.hpp"
#include "runtime/visual/controls/scan_view.hpp"
#include "runtime/visual/scene.hpp"

namespace palpate::visual {

/// What a user turns on and off beside the bodies' surfaces: the regions that they enclose, how stiff they
/// are, slices of the scan. All are off at first, and stay so while an exercise asks to find something.
class Layers {
  public:
    /// `scene` must outlive it. `rendered`: as of felt_text().
    Layers(const Case& patient_case, Scene& scene, std::optional<double> rendered, vtkRenderer* renderer,
           vtkRenderer* front);

    /// Each says what is shown now, or why it is not, in the user's language; empty: the eye sees it.
    std::string turn_regions();
    std::string turn_stiffness();
    std::string turn_slices();
    bool shows_regions() const { return regions_shown_; }
    bool shows_stiffness() const { return stiffness_shown_; }
    bool shows_slice() const { return scan_ && scan_->shows_slice(); }
    /// Slices go with the tool, what is cut open shows the scan where `cut`; what an exercise or a page's
    /// small pictures must not show is turned off.
    void follow(const VisualFrame& frame, bool cut);

  private:
    Scene& scene_;
    std::string names_;  // of the regions
    std::optional<ScanView> scan_;
    bool regions_shown_ = false, stiffness_shown_ = false, exercising_ = false;
};

}  // namespace palpate::visual
