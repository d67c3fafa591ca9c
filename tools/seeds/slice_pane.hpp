// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>
#include <vtkActor.h>
#include <vtkImageActor.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>

#include "tools/seeds/seed_state.hpp"
#include "tools/seeds/slice_picture.hpp"

namespace palpate::seeds {

/// One view's part of the window: the slice through the crosshair with what has grown, the seeds near it, the
/// crosshair and the letters at the edges. VTK's world coordinates are the view's pane coordinates, mm.
class SlicePane {
  public:
    SlicePane(const ImageGrid& grid, SliceView view);

    vtkRenderer* renderer() const { return renderer_; }
    const SliceView& view() const { return view_; }
    const PaneFrame& frame() const { return frame_; }

    /// Draws a state anew.
    void update(const Volume& volume, const SeedState& state, const GreyPreset& grey, const Growth* growth);
    /// Gives the pane its place in a window of `window_size` (pixels).
    void place(const PaneFrame& frame, const Eigen::Vector2d& window_size);

  private:
    void draw_contours(const SlicePicture& picture);
    void draw_crosshair(const SeedState& state);
    void draw_seeds(const SeedState& state);
    vtkSmartPointer<vtkActor> add_actor(vtkPolyData* data, double height);

    ImageGrid grid_;
    SliceView view_;
    PaneFrame frame_;
    vtkNew<vtkRenderer> renderer_;
    vtkNew<vtkImageData> image_;
    vtkNew<vtkImageActor> image_actor_;
    std::vector<vtkSmartPointer<vtkActor>> contours_;  // by label number
    vtkNew<vtkPolyData> crosshair_, seeds_;
    std::array<vtkNew<vtkTextActor>, 4> letters_;  // left, right, top, bottom
    vtkNew<vtkTextActor> title_;
};

/// Gives a renderer its part of a window of `window_size` (pixels).
void set_viewport(vtkRenderer* renderer, const PaneFrame& frame, const Eigen::Vector2d& window_size);

/// Makes a text in the window's type, light on dark.
void set_type(vtkTextActor* actor, int size);

}  // namespace palpate::seeds
