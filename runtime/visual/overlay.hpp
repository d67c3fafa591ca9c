// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <span>
#include <string>
#include <vector>
#include <vtkActor2D.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>

#include "runtime/visual/detail/detail.hpp"
#include "runtime/visual/readings/force_strip.hpp"
#include "runtime/visual/visual_frame.hpp"

namespace palpate::visual {

/// Says why the force went to zero, two lines for each fault, and what else a user must know of contacts and
/// force, a line each; empty where there is nothing to say.
std::string notice_of(const VisualFrame& frame);

/// Depth, torque where a tool turns, and how loop and window keep up: a line each.
std::string figures_of(const VisualFrame& frame, double frames_per_second, const ShownDetail& detail);

/// Names the case, and the bodies that are not linear tissue now.
std::string title_of(const std::string& case_name, const VisualFrame& frame);

/// How much larger texts and bars are than in a window of 1280x720 pixels: as the window, so that they take
/// the same share of it; never so small that they cannot be read.
double display_scale(int width, int height);

/// The figures and key hints that lie over the scene. Texts are set anew five times a second: often enough to
/// read, seldom enough to cost nothing.
class Overlay {
  public:
    /// `turns_tool`: mouse and keyboard turn what is held.
    Overlay(const std::string& case_name, double max_force, std::span<const std::string> cautions,
            bool turns_tool, vtkRenderer* renderer);

    void update(const VisualFrame& frame, double frames_per_second, const ShownDetail& detail);
    /// Shows what the mouse does, or hides it. It is shown from the start and fades by itself.
    void turn_help();
    bool help_shown() const { return help_shown_; }
    /// Shows the case's cautions, or hides them. They are shown from the start until something is touched.
    void turn_cautions();
    /// Hides hints, cautions and all figures but the force while a page lies over the scene, cautions while
    /// an exercise goes on. Hints and what is told keep clear of so many rows of buttons, one or two.
    void make_room(bool for_page, bool for_exercise, int button_rows);
    /// Says something for a few seconds.
    void tell(const std::string& sentence);

  private:
    void show_texts();
    void fade_help(std::chrono::steady_clock::time_point now);
    void place(vtkTextActor* actor, double x, double y, int size, bool right, bool top);
    void fit_window();
    void show_readings(bool with_strip);

    // A text's size in a window of 1280x720.
    struct SizedText {
        vtkTextActor* actor;
        int size;  // points
    };

    std::string case_name_;
    vtkRenderer* renderer_;
    std::vector<SizedText> texts_;
    double scale_ = 0;
    double max_force_;  // N
    bool turns_tool_;
    bool was_touched_ = false;
    bool help_shown_ = true, cautions_shown_ = false;
    bool help_fades_ = true;  // until it is asked for
    std::chrono::steady_clock::duration help_seen_{};
    bool page_shown_ = false, exercise_shown_ = false, filmed_ = false;
    int button_rows_ = 1;
    std::chrono::steady_clock::time_point last_{};
    vtkNew<vtkTextActor> force_, most_force_, health_, figures_, title_, help_, notice_, cautions_, told_;
    std::chrono::steady_clock::time_point told_until_{};
    vtkNew<vtkPoints> bar_points_, whole_bar_points_, light_points_;
    vtkNew<vtkActor2D> bar_, bar_frame_, light_;
    ForceStrip strip_;
};

}  // namespace palpate::visual
