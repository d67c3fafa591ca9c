// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/seeds/seed_window.hpp"

#include <X11/Xlib.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <thread>
#include <vtkCallbackCommand.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>

#include "formats/model/errors.hpp"
#include "tools/seeds/layout.hpp"
#include "tools/seeds/legend.hpp"
#include "tools/seeds/slice_pane.hpp"

namespace palpate::seeds {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double click_slop = 4;      // pixels that a click may wander before it is a drag
constexpr double removal_reach = 14;  // pixels about a right click
constexpr double least_removal = 5;   // mm
constexpr int largest_width = 1280, largest_height = 980;  // pixels
constexpr auto pause = std::chrono::milliseconds(8);

// A connection of our own: VTK aborts where no display answers, and a server that loses its last client
// between a test and the window would start anew.
struct DisplayConnection {
    DisplayConnection() : display(XOpenDisplay(nullptr)) {
        if (display == nullptr)
            throw SystemFailure(
                {.culprit = "DISPLAY",
                 .found = "no X display answers, and the window needs one",
                 .expected = "",
                 .next_step = "log in to a desktop, set DISPLAY, or place seeds in 3D Slicer and save them "
                              "as .mrk.json"});
    }
    DisplayConnection(const DisplayConnection&) = delete;
    DisplayConnection& operator=(const DisplayConnection&) = delete;
    ~DisplayConnection() { XCloseDisplay(display); }

    // What a desktop's bars leave of the screen.
    Vector2d room() const {
        const int screen = DefaultScreen(display);
        return {std::min(largest_width, DisplayWidth(display, screen) - 40),
                std::min(largest_height, DisplayHeight(display, screen) - 90)};
    }

    Display* display;
};

class SeedWindow {
  public:
    SeedWindow(const Volume& volume, const std::string& title, SeedEditor& editor, const GreyScale& greys)
        : volume_(volume),
          editor_(editor),
          value_offset_(greys.offset),
          value_unit_(greys.hounsfield ? " HU" : ""),
          views_(slice_views(volume.grid)),
          panes_{SlicePane(volume.grid, views_[0]), SlicePane(volume.grid, views_[1]),
                 SlicePane(volume.grid, views_[2])},
          legend_(title, editor.state().labels.size()) {
        for (SlicePane& pane : panes_) window_->AddRenderer(pane.renderer());
        window_->AddRenderer(legend_.renderer());
        window_->AddRenderer(legend_.status_renderer());
        const Vector2d room = display_.room();
        window_->SetSize(static_cast<int>(room[0]), static_cast<int>(room[1]));
        window_->SetWindowName(("Palpate seeds: " + title).c_str());
        window_->SetMultiSamples(0);
        interactor_->SetRenderWindow(window_);
        interactor_->SetInteractorStyle(nullptr);
        events_->SetClientData(this);
        events_->SetCallback([](vtkObject*, unsigned long event, void* self, void*) {
            static_cast<SeedWindow*>(self)->handle(event);
        });
        for (const unsigned long event :
             {vtkCommand::LeftButtonPressEvent, vtkCommand::LeftButtonReleaseEvent,
              vtkCommand::MiddleButtonPressEvent, vtkCommand::MiddleButtonReleaseEvent,
              vtkCommand::RightButtonPressEvent, vtkCommand::RightButtonReleaseEvent,
              vtkCommand::MouseMoveEvent, vtkCommand::MouseWheelForwardEvent,
              vtkCommand::MouseWheelBackwardEvent, vtkCommand::KeyPressEvent, vtkCommand::ConfigureEvent,
              vtkCommand::ExitEvent})
            interactor_->AddObserver(event, events_);
        interactor_->Initialize();
        window_->SetCurrentCursor(VTK_CURSOR_CROSSHAIR);
    }

    void run() {
        while (!editor_.closed()) {
            interactor_->ProcessEvents();
            editor_.poll();
            if (stale_ || drawn_revision_ != editor_.revision()) draw();
            std::this_thread::sleep_for(pause);
        }
    }

  private:
    void draw() {
        const int* pixels = window_->GetSize();
        const Vector2d size(pixels[0], pixels[1]);
        const Layout layout = layout_for(size);
        const bool changed = drawn_revision_ != editor_.revision() || size != drawn_size_;
        for (std::size_t n = 0; n < panes_.size(); ++n) {
            panes_[n].place(layout.panes[n], size);
            if (changed) panes_[n].update(volume_, editor_.state(), editor_.grey(), editor_.growth().get());
        }
        legend_.place(layout, size);
        legend_.update(editor_.state(), editor_.grey(), editor_.growth().get());
        legend_.set_pointer(pointer_text());
        legend_.set_message(editor_.message());
        window_->Render();
        stale_ = false;
        drawn_revision_ = editor_.revision();
        drawn_size_ = size;
    }

    // Zoomed in, what is seen moves only when the crosshair would leave it: a click moves nothing.
    Layout layout_for(const Vector2d& size) {
        const auto& crosshair = editor_.state().crosshair;
        if (editor_.zoom() != drawn_zoom_) zoom_middle_ = crosshair;
        drawn_zoom_ = editor_.zoom();
        Layout layout = lay_out(volume_.grid, views_, size, drawn_zoom_, zoom_middle_);
        const Vector3d index(crosshair[0], crosshair[1], crosshair[2]);
        for (std::size_t n = 0; n < views_.size(); ++n)
            if (!layout.panes[n].shows(pane_point(views_[n], volume_.grid, index))) {
                zoom_middle_ = crosshair;
                return lay_out(volume_.grid, views_, size, drawn_zoom_, zoom_middle_);
            }
        return layout;
    }

    Vector2d pointer() const {
        const int* position = interactor_->GetEventPosition();
        return {position[0], position[1]};
    }

    const SlicePane* pane_under_pointer() const {
        const auto found = std::ranges::find_if(
            panes_, [&](const SlicePane& pane) { return pane.frame().holds(pointer()); });
        return found != panes_.end() ? &*found : nullptr;
    }

    // The continuous voxel index under the pointer, on the slice that is seen there.
    std::optional<Vector3d> index_under_pointer() const {
        const SlicePane* pane = pane_under_pointer();
        if (pane == nullptr) return {};
        const SliceView& view = pane->view();
        return index_at(view, volume_.grid, editor_.state().crosshair[view.across],
                        pane->frame().point_at(pointer()));
    }

    std::string pointer_text() const {
        const auto index = index_under_pointer();
        if (!index) return "";
        const auto voxel = [&](int axis) { return static_cast<std::int32_t>(std::lround((*index)[axis])); };
        const std::size_t offset = volume_.grid.offset(voxel(0), voxel(1), voxel(2));
        const Vector3d p = volume_.grid.point_of(*index);
        return fmt::format("LPS {:.1f}, {:.1f}, {:.1f} mm      {:.0f}{}", p[0], p[1], p[2],
                           volume_.values[offset] - value_offset_, value_unit_);
    }

    void handle(unsigned long event) {
        switch (event) {
            case vtkCommand::LeftButtonPressEvent:
                if (interactor_->GetShiftKey())
                    drag_crosshair(true);
                else
                    place();
                break;
            case vtkCommand::MiddleButtonPressEvent:
                drag_crosshair(true);
                break;
            case vtkCommand::LeftButtonReleaseEvent:
            case vtkCommand::MiddleButtonReleaseEvent:
                drag_crosshair(false);
                break;
            case vtkCommand::RightButtonPressEvent:
                right_press_ = pointer();
                right_dragged_ = false;
                break;
            case vtkCommand::RightButtonReleaseEvent:
                if (right_press_ && !right_dragged_) remove();
                right_press_.reset();
                break;
            case vtkCommand::MouseMoveEvent:
                pointer_moved();
                break;
            case vtkCommand::MouseWheelForwardEvent:
                scroll_under_pointer(1);
                break;
            case vtkCommand::MouseWheelBackwardEvent:
                scroll_under_pointer(-1);
                break;
            case vtkCommand::KeyPressEvent:
                key_pressed(interactor_->GetKeySym());
                break;
            case vtkCommand::ConfigureEvent:
                stale_ = true;
                break;
            default:
                editor_.quit();
                break;
        }
    }

    void place() {
        if (const auto index = index_under_pointer())
            editor_.place(*index);
        else if (pane_under_pointer() != nullptr)
            editor_.say("outside the volume");
    }

    void remove() {
        if (const auto index = index_under_pointer())
            editor_.remove(*index,
                           std::max(least_removal, removal_reach * pane_under_pointer()->frame().pixel));
    }

    void drag_crosshair(bool on) {
        dragging_ = on;
        if (on) pointer_moved();
    }

    void pointer_moved() {
        stale_ = true;
        if (dragging_)
            if (const auto index = index_under_pointer()) editor_.move_crosshair(*index);
        if (!right_press_) return;
        right_dragged_ = right_dragged_ || (pointer() - *right_press_).norm() > click_slop;
        const int* before = interactor_->GetLastEventPosition();
        const Vector2d moved = pointer() - Vector2d(before[0], before[1]);
        if (right_dragged_) editor_.drag_grey(moved[0], moved[1]);
    }

    void scroll_under_pointer(int steps) {
        if (const SlicePane* pane = pane_under_pointer()) editor_.scroll(pane->view(), steps);
    }

    void key_pressed(const char* symbol) {
        std::string key = symbol ? symbol : "";
        std::ranges::transform(key, key.begin(),
                               [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        if (key.starts_with("kp_") && key.size() == 4) key = key.substr(3);  // digits of the number pad
        if (key == "up" || key == "prior") return scroll_under_pointer(1);
        if (key == "down" || key == "next") return scroll_under_pointer(-1);
        if (key == "h") legend_.toggle_help();
        editor_.key(key);
    }

    DisplayConnection display_;
    const Volume& volume_;
    SeedEditor& editor_;
    double value_offset_;
    std::string value_unit_;
    std::array<SliceView, 3> views_;
    std::array<std::int32_t, 3> zoom_middle_{0, 0, 0};  // voxel
    vtkNew<vtkRenderWindow> window_;
    vtkNew<vtkRenderWindowInteractor> interactor_;
    vtkNew<vtkCallbackCommand> events_;
    std::array<SlicePane, 3> panes_;
    Legend legend_;
    bool dragging_ = false;
    std::optional<Vector2d> right_press_;
    bool right_dragged_ = false;
    bool stale_ = true;
    int drawn_revision_ = 0;
    Vector2d drawn_size_ = Vector2d::Zero();
    double drawn_zoom_ = 0;
};

}  // namespace

SeedWindowResult run_seed_window(const Volume& volume, const SeedWindowSettings& settings) {
    SeedEditor editor(volume, settings.state, settings.greys, settings.save, settings.growing);
    SeedWindow(volume, settings.title, editor, settings.greys).run();
    editor.finish();
    return {editor.state(), editor.growth(), editor.growths(), editor.longest_growth()};
}

}  // namespace palpate::seeds
