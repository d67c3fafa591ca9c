// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>
#include <vtkActor2D.h>
#include <vtkChartXY.h>
#include <vtkContextActor.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>

#include "runtime/visual/lesson/lesson_view.hpp"
#include "runtime/visual/lesson/thumbnails.hpp"

namespace palpate::visual {

/// What an exercise writes over the scene: instruction, progress and force band while it runs, a page with
/// figures, curves and choices otherwise. Sizes follow the window: display_scale().
class LessonPanel {
  public:
    explicit LessonPanel(vtkRenderer* renderer);

    /// `pictures`: those of the page, as far as they are there; `force` (N) is pointed at in the band;
    /// `width` and `height` are the window's, pixels.
    void update(const LessonView& view, const Thumbnails& pictures, double force, int width, int height);

    /// The key of the choice under a place of the window (pixels from its lower left); empty: none.
    std::string choice_at(int x, int y) const;
    /// Whether a page lies over a place of the window.
    bool covers(int x, int y) const;
    /// Lights up the choice under a place of the window.
    void hover(int x, int y);

  private:
    struct Box {
        double left, bottom, right, top;  // pixels
    };
    static Box card_box(std::size_t card, double left, double top, double width, double height);
    void show_page(const LessonPage& page, const Thumbnails& pictures, int width, int height);
    void show_choice(const LessonChoice& choice, const std::string& text, double x, double y, double scale,
                     const Box& box);
    void show_picture(vtkImageData* pixels, double left, double bottom, double scale);
    void show_band(const LessonView& view, double force, int width, int height);
    void hide_page();

    vtkRenderer* renderer_;
    vtkNew<vtkTextActor> instruction_, status_, warning_, title_, text_, names_, values_;
    vtkNew<vtkPoints> sheet_points_, below_points_, within_points_, above_points_, pointer_points_;
    vtkNew<vtkActor2D> sheet_, below_, within_, above_, pointer_;
    std::vector<vtkSmartPointer<vtkTextActor>> choices_;
    std::vector<vtkSmartPointer<vtkActor2D>> pictures_;
    std::vector<std::string> keys_;
    std::vector<Box> boxes_;
    std::vector<vtkSmartPointer<vtkContextActor>> charts_;
    std::string shown_;  // what the page's content was, to make it anew only when it changes
};

}  // namespace palpate::visual
