// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>
#include <vtkNew.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>

#include "tools/seeds/grey_presets.hpp"
#include "tools/seeds/growth.hpp"
#include "tools/seeds/layout.hpp"
#include "tools/seeds/seed_state.hpp"

namespace palpate::seeds {

/// The window's texts: labels with their keys, colours, seeds and volumes, the grey window, why nothing could
/// be made of the seeds, the help, and the status line with the place under the pointer (left) and what
/// happened last (right).
class Legend {
  public:
    Legend(const std::string& title, std::size_t labels);

    vtkRenderer* renderer() const { return renderer_; }
    vtkRenderer* status_renderer() const { return status_renderer_; }

    void update(const SeedState& state, const GreyPreset& grey, const Growth* growth);
    void set_pointer(const std::string& text) { pointer_->SetInput(text.c_str()); }
    void set_message(const std::string& text) { message_->SetInput(text.c_str()); }
    void toggle_help();
    void place(const Layout& layout, const Eigen::Vector2d& window_size);

  private:
    void show_help();

    struct Row {
        vtkSmartPointer<vtkTextActor> key, text;
    };
    vtkNew<vtkRenderer> renderer_, status_renderer_;
    vtkNew<vtkTextActor> title_, grey_, refused_, help_keys_, help_, pointer_, message_;
    std::vector<Row> rows_;  // by label number
    std::string refusal_;
    bool help_wanted_ = true;
    double width_ = 0;  // pixels
};

}  // namespace palpate::seeds
