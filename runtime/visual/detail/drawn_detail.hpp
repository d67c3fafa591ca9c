// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <vector>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include "runtime/visual/detail/coarse_pixels.hpp"
#include "runtime/visual/detail/detail.hpp"
#include "runtime/visual/detail/detail_control.hpp"
#include "runtime/visual/detail/occlusion.hpp"
#include "runtime/visual/scene.hpp"

namespace palpate::visual {

/// Draws a scene in as much detail as the machine has time for.
class DrawnDetail {
  public:
    /// All outlive this.
    DrawnDetail(vtkRenderWindow* window, vtkRenderer* renderer, Scene* scene)
        : window_(window), renderer_(renderer), scene_(scene) {}

    /// A frame has come `seconds` after the one before: the next has more, less or the same.
    void frame_took(double seconds);

    /// Draws everything and then calls `work`, for a picture that is kept. Where speak_to_display() runs.
    void with_everything(const std::function<void()>& work);

    /// Level, levels and changes; nothing before the first frame.
    const std::optional<DetailControl>& control() const { return control_; }

  private:
    void use(const Detail& detail);
    const Detail& affordable() const;

    vtkRenderWindow* window_;
    vtkRenderer* renderer_;
    Scene* scene_;
    std::vector<Detail> levels_;
    std::optional<DetailControl> control_;  // once the window has its size
    vtkNew<CoarsePixels> coarse_pixels_;
    vtkSmartPointer<vtkRenderPass> occlusion_;  // once it is drawn
};

}  // namespace palpate::visual
