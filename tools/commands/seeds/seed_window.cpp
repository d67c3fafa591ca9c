// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/seeds/seed_window.hpp"

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
#include "tools/commands/seeds/layout.hpp"
#include "tools/commands/seeds/legend.hpp"
#include "tools/commands/seeds/slice_pane.hpp"

namespace palpate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double click_slop = 4;       // pixels that a click may wander before it is a drag
constexpr double removal_reach = 14;   // pixels about a right click
constexpr double least_removal = 5;    // mm
constexpr double contrast_step = 200;  // pixels of right drag for a factor of e
constexpr double largest_zoom = 4;
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
    SeedWindow(const Volume& volume, SeedWindowSettings settings)
        : volume_(volume),
          state_(std::move(settings.state)),
          greys_(std::move(settings.greys)),
          save_(std::move(settings.save)),
          views_(slice_views(volume.grid)),
          grey_(greys_.presets.front()),
          panes_{SlicePane(volume.grid, views_[0]), SlicePane(volume.grid, views_[1]),
                 SlicePane(volume.grid, views_[2])},
          legend_(settings.title, state_.labels.size()),
          worker_(volume) {
        for (SlicePane& pane : panes_) window_->AddRenderer(pane.renderer());
        window_->AddRenderer(legend_.renderer());
        window_->AddRenderer(legend_.status_renderer());
        const Vector2d room = display_.room();
        window_->SetSize(static_cast<int>(room[0]), static_cast<int>(room[1]));
        window_->SetWindowName(("Palpate seeds: " + settings.title).c_str());
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
        legend_.set_message("click into the structure");
        if (!state_.seeds.empty()) grow();
    }

    SeedWindowResult run() {
        while (!closed_) {
            interactor_->ProcessEvents();
            take_growth();
            if (stale_) draw();
            std::this_thread::sleep_for(pause);
        }
        worker_.wait();
        take_growth();
        return {std::move(state_), growth_, growths_, longest_growth_};
    }

  private:
    void draw() {
        stale_ = false;
        const int* pixels = window_->GetSize();
        const Vector2d size(pixels[0], pixels[1]);
        const Layout layout = layout_for(size);
        for (std::size_t n = 0; n < panes_.size(); ++n) {
            panes_[n].place(layout.panes[n], size);
            if (picture_stale_) panes_[n].update(volume_, state_, grey_, growth_.get());
        }
        picture_stale_ = false;
        legend_.place(layout, size);
        legend_.update(state_, grey_, growth_.get());
        legend_.set_pointer(pointer_text());
        window_->Render();
    }

    // Zoomed in, what is seen moves only when the crosshair would leave it: a click moves nothing.
    Layout layout_for(const Vector2d& size) {
        Layout layout = lay_out(volume_.grid, views_, size, zoom_, zoom_middle_);
        const Vector3d index(state_.crosshair[0], state_.crosshair[1], state_.crosshair[2]);
        for (std::size_t n = 0; n < views_.size(); ++n)
            if (!layout.panes[n].shows(pane_point(views_[n], volume_.grid, index))) {
                zoom_middle_ = state_.crosshair;
                return lay_out(volume_.grid, views_, size, zoom_, zoom_middle_);
            }
        return layout;
    }

    void refresh() { stale_ = picture_stale_ = true; }

    void say(const std::string& message) {
        legend_.set_message(message);
        stale_ = true;
    }

    void grow() {
        worker_.request(state_.seeds);
        say(state_.seeds.empty() ? "no seeds left" : "growing ...");
        refresh();
    }

    void take_growth() {
        const auto grown = worker_.take();
        if (!grown) return;
        growth_ = grown;
        refresh();
        if (grown->map.labels.empty()) return;
        ++growths_;
        longest_growth_ = std::max(longest_growth_, grown->seconds);
        if (!worker_.busy()) say(growth_text());
    }

    std::string growth_text() const {
        std::string text;
        for (std::size_t n = 0; n < growth_->map.names.size(); ++n)
            if (growth_->map.names[n].name == state_.labels[state_.active])
                text = fmt::format("{} {:.1f} ml, ", growth_->map.names[n].name, growth_->volume_ml[n]);
        return text + fmt::format("grown in {:.2f} s", growth_->seconds);
    }

    Vector2d pointer() const {
        const int* position = interactor_->GetEventPosition();
        return {position[0], position[1]};
    }

    const SlicePane* pane_at(const Vector2d& position) const {
        const auto found =
            std::ranges::find_if(panes_, [&](const SlicePane& pane) { return pane.frame().holds(position); });
        return found != panes_.end() ? &*found : nullptr;
    }

    // The continuous voxel index under a position in the window, on the slice that is seen there.
    std::optional<Vector3d> index_under(const Vector2d& position) const {
        const SlicePane* pane = pane_at(position);
        if (pane == nullptr) return {};
        const SliceView& view = pane->view();
        return index_at(view, volume_.grid, state_.crosshair[static_cast<std::size_t>(view.across)],
                        pane->frame().point_at(position));
    }

    std::string pointer_text() const {
        const auto index = index_under(pointer());
        if (!index) return "";
        const auto voxel = [&](int axis) { return static_cast<std::int32_t>(std::lround((*index)[axis])); };
        const std::size_t offset = volume_.grid.offset(voxel(0), voxel(1), voxel(2));
        const Vector3d p = volume_.grid.point_of(*index);
        return fmt::format("LPS {:.1f}, {:.1f}, {:.1f} mm      {:.0f}{}", p[0], p[1], p[2],
                           volume_.values[offset] - greys_.offset, greys_.hounsfield ? " HU" : "");
    }

    void handle(unsigned long event) {
        if (event != vtkCommand::MouseMoveEvent && event != vtkCommand::ConfigureEvent &&
            event != vtkCommand::ExitEvent && event != vtkCommand::KeyPressEvent)
            asked_to_quit_ = false;
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
                refresh();
                break;
            default:
                quit();
                break;
        }
    }

    void place() {
        if (const auto index = index_under(pointer())) {
            place_seed(state_, volume_.grid, *index);
            grow();
        } else if (pane_at(pointer()) != nullptr) {
            say("outside the volume");
        }
    }

    void remove() {
        const auto index = index_under(pointer());
        if (!index) return;
        const double reach = std::max(least_removal, removal_reach * pane_at(pointer())->frame().pixel);
        if (remove_nearest(state_, volume_.grid.point_of(*index), reach))
            grow();
        else
            say("no seed here");
    }

    void drag_crosshair(bool on) {
        dragging_ = on;
        if (on) pointer_moved();
    }

    void pointer_moved() {
        stale_ = true;
        const Vector2d now = pointer();
        if (dragging_) {
            if (const auto index = index_under(now)) move_crosshair(state_, volume_.grid, *index);
            refresh();
        }
        if (!right_press_) return;
        if (!right_dragged_ && (now - *right_press_).norm() <= click_slop) return;
        const int* before = interactor_->GetLastEventPosition();
        right_dragged_ = true;
        grey_.name = "your own";
        grey_.width *= std::exp((now[0] - before[0]) / contrast_step);
        grey_.level -= (now[1] - before[1]) * grey_.width / (2 * contrast_step);
        refresh();
    }

    void scroll_under_pointer(int steps) {
        const SlicePane* pane = pane_at(pointer());
        if (pane == nullptr) return;
        scroll(state_, volume_.grid, pane->view(), steps);
        refresh();
    }

    void next_grey(std::size_t steps) {
        preset_ = (preset_ + steps) % greys_.presets.size();
        grey_ = greys_.presets[preset_];
        refresh();
    }

    void key_pressed(const char* symbol) {
        std::string key = symbol ? symbol : "";
        if (key.starts_with("KP_") && key.size() == 4) key = key.substr(3);  // digits of the number pad
        if (key.size() == 1) key[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(key[0])));
        if (key == "q" || key == "Escape") return quit();
        asked_to_quit_ = false;
        refresh();
        if (key.size() == 1 && key[0] >= '0' && key[0] <= '9')
            choose_label(state_, static_cast<std::size_t>(key[0] - '0'));
        else if (key == "plus" || key == "equal" || key == "KP_Add")
            next_grey(1);
        else if (key == "minus" || key == "KP_Subtract")
            next_grey(greys_.presets.size() - 1);
        else if (key == "Up" || key == "Prior")
            scroll_under_pointer(1);
        else if (key == "Down" || key == "Next")
            scroll_under_pointer(-1);
        else if (key == "z")
            zoom_in();
        else if (key == "h")
            legend_.toggle_help();
        else if (key == "s")
            save();
        else if ((key == "x" || key == "Delete") && remove_last(state_))
            grow();
        else if (key == "u" && undo(state_))
            grow();
    }

    void zoom_in() {
        zoom_ = zoom_ < largest_zoom ? 2 * zoom_ : 1;
        zoom_middle_ = state_.crosshair;
    }

    void save() {
        if (state_.seeds.empty()) return say("nothing to save: click into the structure first");
        try {
            const std::string place = save_(state_.seeds);
            state_.saved = state_.seeds;
            say(fmt::format("saved {} seed{} to {}", state_.seeds.size(), state_.seeds.size() == 1 ? "" : "s",
                            place));
        } catch (const Error& error) {
            say(error.what());
        }
    }

    void quit() {
        closed_ = asked_to_quit_ || !unsaved(state_);
        asked_to_quit_ = true;
        if (!closed_) say("seeds are not saved: S saves, Q again quits without");
    }

    DisplayConnection display_;
    const Volume& volume_;
    SeedState state_;
    GreyScale greys_;
    std::function<std::string(std::span<const Seed>)> save_;
    std::array<SliceView, 3> views_;
    GreyPreset grey_;
    std::size_t preset_ = 0;
    double zoom_ = 1;
    std::array<std::int32_t, 3> zoom_middle_{0, 0, 0};  // voxel
    vtkNew<vtkRenderWindow> window_;
    vtkNew<vtkRenderWindowInteractor> interactor_;
    vtkNew<vtkCallbackCommand> events_;
    std::array<SlicePane, 3> panes_;
    Legend legend_;
    std::shared_ptr<const Growth> growth_;
    int growths_ = 0;
    double longest_growth_ = 0;
    bool dragging_ = false;
    std::optional<Vector2d> right_press_;
    bool right_dragged_ = false;
    bool asked_to_quit_ = false;
    bool closed_ = false;
    bool stale_ = true, picture_stale_ = true;
    GrowthWorker worker_;
};

}  // namespace

SeedWindowResult run_seed_window(const Volume& volume, SeedWindowSettings settings) {
    return SeedWindow(volume, std::move(settings)).run();
}

}  // namespace palpate
