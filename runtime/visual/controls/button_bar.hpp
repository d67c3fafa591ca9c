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

/// A button in the user's language.
struct ButtonText {
    std::string key;    ///< X11 name, lower case, that does the same
    std::string text;   ///< on it, the key among it: "C  Cut"
    std::string tip{};  ///< beside it while the pointer rests on it; empty: none

    bool operator==(const ButtonText&) const = default;
};

/// One for each of window_keys(). `has_jaws`: a forceps is held, whose keys have buttons too.
std::vector<ButtonText> window_buttons(bool has_jaws);

/// Buttons in a row along the lower edge of the window; a click is as good as the key. VTK's own text actors:
/// the window is VTK's, and a toolkit beside it (Qt, Dear ImGui) would bring an event loop or an OpenGL
/// loader of its own. Sizes follow the window: display_scale().
class ButtonBar {
  public:
    /// `row`: counted from the window's edge, from 0 on.
    ButtonBar(vtkRenderer* renderer, int row);

    /// Is that row from the next update() on.
    void move_to(int row);
    /// What is in the row from now on; nothing is on.
    void set(const std::vector<ButtonText>& buttons);
    /// Shows the row, or nothing while a page lies over the scene. `width` and `height`: pixels.
    void update(bool shown, int width, int height);
    /// Marks a key's button as on, as of something that is shown or goes on; off at first.
    void light(std::string_view key, bool on);
    /// The key of the button under a place of the window (pixels from its lower left); empty: none.
    std::string key_at(int x, int y) const;
    /// Lights up the button under that place, if there is one, and shows its tip.
    void hover(int x, int y);

  private:
    struct Button {
        ButtonText text;
        vtkSmartPointer<vtkTextActor> actor;
        double left = 0, right = 0;  // pixels
        bool on = false;
    };

    void fit(int width, int height);
    double lay_out(int font, double scale);
    void paint(const Button& button, bool under_pointer);

    vtkRenderer* renderer_;
    int row_;
    std::vector<ButtonText> texts_;
    std::vector<Button> buttons_;
    vtkNew<vtkTextActor> tip_;
    bool shown_ = false;
    int width_ = 0, height_ = 0;   // that the row was made for
    double bottom_ = 0, top_ = 0;  // of the row, pixels
};

}  // namespace palpate::visual
