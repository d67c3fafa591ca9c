// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>
#include <vtkNew.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>

namespace palpate::visual {

/// A button for each of window_keys(), in a row along the lower edge of the window; a click is as good as the
/// key. VTK's own text actors: the window is VTK's, and a toolkit beside it (Qt, Dear ImGui) would bring an
/// event loop or an OpenGL loader of its own. Sizes follow the window: display_scale().
class ButtonBar {
  public:
    /// `has_jaws`: a forceps is held, whose keys have buttons too.
    ButtonBar(vtkRenderer* renderer, bool has_jaws);

    /// Shows the row, or nothing while a page lies over the scene. `width` and `height`: pixels.
    void update(bool shown, int width, int height);
    /// Marks a key's button as on, as of something that is shown or goes on; off at first.
    void light(std::string_view key, bool on);
    /// The key of the button under a place of the window (pixels from its lower left); empty: none.
    std::string_view key_at(int x, int y) const;
    /// Shows the tip of the button under that place, if there is one.
    void hover(int x, int y);

  private:
    struct Button {
        std::string_view key, tip;
        vtkSmartPointer<vtkTextActor> text;
        double left = 0, right = 0;  // pixels
        bool on = false;
    };

    void fit(int width, int height);
    void paint(const Button& button, bool under_pointer);

    vtkRenderer* renderer_;
    std::vector<Button> buttons_;
    vtkNew<vtkTextActor> tip_;
    bool shown_ = false;
    int width_ = 0, height_ = 0;  // that the row was made for
    double top_ = 0;              // of the row, pixels
};

}  // namespace palpate::visual
