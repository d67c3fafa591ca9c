// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/train_window.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include "formats/model/errors.hpp"
#include "runtime/texts/translated.hpp"
#include "runtime/visual/controls/button_bar.hpp"
#include "runtime/visual/controls/free_path.hpp"
#include "runtime/visual/controls/layers.hpp"
#include "runtime/visual/controls/opened_window.hpp"
#include "runtime/visual/controls/view_history.hpp"
#include "runtime/visual/cut/near_plane.hpp"
#include "runtime/visual/detail/drawn_detail.hpp"
#include "runtime/visual/detail/frame_pace.hpp"
#include "runtime/visual/hand/pointed_scene.hpp"
#include "runtime/visual/hand/pointer_hand.hpp"
#include "runtime/visual/hand/steering.hpp"
#include "runtime/visual/hand/view_control.hpp"
#include "runtime/visual/inside/endoscope.hpp"
#include "runtime/visual/lesson/lesson_panel.hpp"
#include "runtime/visual/lesson/lesson_scene.hpp"
#include "runtime/visual/lesson/thumbnails.hpp"
#include "runtime/visual/overlay.hpp"
#include "runtime/visual/pictures.hpp"
#include "runtime/visual/playback/timeline.hpp"
#include "runtime/visual/scene.hpp"
#include "runtime/visual/tool_shadow.hpp"

namespace palpate::visual {

using texts::translated;
namespace {

using Eigen::Vector3d;

constexpr double key_depth = 0.5;     // mm a key press
constexpr double wheel_depth = 0.5;   // mm a notch
constexpr double zoom_step = 1.15;    // a key press
constexpr double zoom_pixels = 20;    // of a drag that zooms by one step
constexpr double shadow_share = 0.3;  // of the field: how far the tool's shadow falls

// What moving the pointer does while a button is held.
enum class Drag { none, turn, shift, roll, zoom, carry, tilt };

}  // namespace

struct TrainWindow::Parts {
    Parts(std::shared_ptr<OpenedWindow> opened_window, const Case& patient_case,
          const WindowSettings& window_settings)
        : opened(std::move(opened_window)),
          settings(window_settings),
          hand(window_settings.start, tip_reach(patient_case)),
          rigid_count(patient_case.rigid_bodies.size()),
          case_name(patient_case.name),
          scene(patient_case, window_settings.sight, window_settings.rigid_budget, window_settings.jaw_length,
                renderer, front),
          layers(patient_case, scene, window_settings.rendered, renderer, front),
          shadow(renderer),
          overlay(patient_case.name, (window_settings.jaw_length ? 2 : 1) * patient_case.haptics.max_force,
                  window_settings.cautions, window_settings.orientation.has_value(), front),
          lesson_scene(renderer),
          thumbnails(window, window_settings.sight),
          panel(front),
          buttons(front, 0),
          lesson_buttons(front, 1),
          timeline(front, interactor),
          tool_radius(patient_case.haptics.tool_radius),
          cut(window_settings.sight.blocked) {
        buttons.set(window_buttons(window_settings.jaw_length.has_value()));
        renderer->SetNearClippingPlaneTolerance(
            0.002);  // of the far one: an eye in a passage is near its walls
        window->SetWindowName(("Palpate: " + patient_case.name).c_str());
        events->SetClientData(this);
        events->SetCallback([](vtkObject*, unsigned long event, void* self, void*) {
            static_cast<Parts*>(self)->handle(event);
        });
        for (const unsigned long event :
             {vtkCommand::LeftButtonPressEvent, vtkCommand::LeftButtonReleaseEvent,
              vtkCommand::RightButtonPressEvent, vtkCommand::RightButtonReleaseEvent,
              vtkCommand::MiddleButtonPressEvent, vtkCommand::MiddleButtonReleaseEvent,
              vtkCommand::MouseMoveEvent, vtkCommand::MouseWheelForwardEvent,
              vtkCommand::MouseWheelBackwardEvent, vtkCommand::KeyPressEvent, vtkCommand::ExitEvent})
            interactor->AddObserver(event, events);
        for (vtkActor* body : scene.bodies()) thumbnails.renderer()->AddActor(body);
        reset();
    }

    void reset() {
        hand.put(settings.start);
        orientation = settings.orientation;
        endoscope.turn_off();
        look_from(renderer->GetActiveCamera(), settings.sight);
    }

    void look(const VisualFrame& frame) {
        const auto [tip, shaft] = scene.tool_parts();
        const auto [shade, rim] = shadow.parts();
        // What is at the eye, or the other view's.
        std::vector<vtkActor*> hidden{tip, shaft, shade, rim};
        std::ranges::copy(scene.sections(), std::back_inserter(hidden));
        scene.show_tool(!endoscope.fills_window());
        if (endoscope.fills_window()) shadow.update(frame.tool_position, std::nullopt);
        endoscope.follow({.tip = frame.tool_position,
                          .shaft = shaft_of(frame),
                          .orientation = frame.tool_orientation,
                          .look_at = frame.lesson.look_at},
                         tool_radius, frame.film_rate_hz ? 1 / *frame.film_rate_hz : frame_seconds, hidden);
        if (!endoscope.fills_window()) set_clipping_range(frame.tool_position);
        scene.follow_cut(renderer, cuts());
        layers.follow(frame, cuts());
    }

    bool cuts() const { return cut && !endoscope.fills_window(); }

    // With the cut on, whatever stands between eye and target or tool falls before the near plane.
    // Rasterisers clip there for nothing, where clipping in a shader costs a third of the frames.
    void set_clipping_range(const Vector3d& tool) {
        renderer->ResetCameraClippingRange();
        front->GetActiveCamera()->DeepCopy(renderer->GetActiveCamera());
        front->ResetCameraClippingRange();
        if (cut) clip_before(renderer->GetActiveCamera(), settings.sight, tool, tool_radius);
    }

    void handle(unsigned long event) {
        switch (event) {
            case vtkCommand::LeftButtonPressEvent:
                if (!click()) left_pressed();
                break;
            case vtkCommand::MiddleButtonPressEvent:
                begin(Drag::shift);
                break;
            case vtkCommand::RightButtonPressEvent:
                begin(interactor->GetControlKey()                ? Drag::zoom
                      : orientation && interactor->GetShiftKey() ? Drag::tilt
                                                                 : Drag::turn);
                break;
            case vtkCommand::LeftButtonReleaseEvent:
            case vtkCommand::MiddleButtonReleaseEvent:
            case vtkCommand::RightButtonReleaseEvent:
                begin(Drag::none);
                break;
            case vtkCommand::MouseMoveEvent:
                pointer_moved();
                break;
            case vtkCommand::MouseWheelForwardEvent:
                wheel_turned(1);
                break;
            case vtkCommand::MouseWheelBackwardEvent:
                wheel_turned(-1);
                break;
            case vtkCommand::KeyPressEvent:
                key_pressed(interactor->GetKeySym());
                break;
            default:
                closed = true;
                break;
        }
    }

    // Whether the pointer was on a button or on a page, whose choice is taken if it was on one.
    bool click() {
        const int* at = interactor->GetEventPosition();
        if (const std::string key = button_at(at[0], at[1]); !key.empty()) {
            act_on(key);
            return true;
        }
        std::string choice = panel.choice_at(at[0], at[1]);
        if (choice.empty()) return panel.covers(at[0], at[1]);
        keys.push_back(std::move(choice));
        return true;
    }

    void left_pressed() {
        if (interactor->GetShiftKey())
            begin(Drag::shift);
        else if (interactor->GetControlKey())
            begin(Drag::roll);
        else if (endoscope.fills_window())
            begin(Drag::carry);
        else if (const int* now = interactor->GetEventPosition(); !endoscope.covers(now[0], now[1]))
            settings.jaw_length ? begin(Drag::carry) : press(true);
    }

    void press(bool on) {
        if (on && hand_stays) return;
        const int* now = interactor->GetEventPosition();
        if (on) hand.point({now[0], now[1]});
        hand.press(on);
    }

    void begin(Drag what) {
        drag = what;
        if (what != Drag::none && what != Drag::carry && what != Drag::tilt) keep_view();
        hand.press(false);
    }

    void pointer_moved() {
        const int* now = interactor->GetEventPosition();
        panel.hover(now[0], now[1]);
        buttons.hover(now[0], now[1]);
        lesson_buttons.hover(now[0], now[1]);
        const int* before = interactor->GetLastEventPosition();
        const double dx = now[0] - before[0], dy = now[1] - before[1];
        if (drag == Drag::none) {
            const bool leads = !hand_stays && !settings.jaw_length && !endoscope.covers(now[0], now[1]);
            if (leads && !covered(now[0], now[1])) hand.point({now[0], now[1]});
            return;
        }
        vtkCamera* camera = renderer->GetActiveCamera();
        const int height = window->GetSize()[1];
        if (hand_stays && (drag == Drag::carry || drag == Drag::tilt)) return;
        if (drag == Drag::carry) return drag_hand(steering(), dx, dy);
        if (drag == Drag::tilt) return tilt_tool(steering(), dx, dy);
        if (drag == Drag::turn) turn_view(camera, dx, dy);
        if (drag == Drag::shift) pan_view(camera, dx, dy, height);
        if (drag == Drag::roll) roll_view(camera, dx);
        if (drag == Drag::zoom) camera->Dolly(std::pow(zoom_step, dy / zoom_pixels));
        hand.view_changed();
    }

    Steering steering() {
        std::optional<Vector3d> shaft, seen_from;
        if (settings.jaw_length && orientation)
            shaft = *orientation * Vector3d::UnitZ();
        else if (endoscope.fills_window())
            seen_from = tip;
        return {hand,      renderer->GetActiveCamera(),          window->GetSize()[1], shaft,
                seen_from, orientation ? &*orientation : nullptr};
    }

    // The key of the button there; empty: none.
    std::string button_at(int x, int y) const {
        const std::string key = lesson_buttons.key_at(x, y);
        return key.empty() ? buttons.key_at(x, y) : key;
    }

    // Whether something to click on lies over the scene there.
    bool covered(int x, int y) const { return panel.covers(x, y) || !button_at(x, y).empty(); }

    void keep_view() {
        if (!endoscope.fills_window())
            views.keep(renderer->GetActiveCamera(), std::chrono::steady_clock::now());
    }

    void undo_view() {
        if (endoscope.fills_window()) return;
        if (!views.back(renderer->GetActiveCamera())) overlay.tell(translated("this is the first view"));
        hand.view_changed();
    }

    void zoom(double steps) {
        keep_view();
        renderer->GetActiveCamera()->Dolly(std::pow(zoom_step, steps));
        hand.view_changed();
    }

    void wheel_turned(double notches) {
        const Steering now = steering();
        if (!hand_stays && (now.tip || (now.shaft && drag == Drag::carry)))
            roll_hand(now, notches);
        else if (hand.pressing())
            hand.deepen(wheel_depth * notches);
        else
            zoom(notches);
    }

    // What is drawn, at rest.
    std::span<const collision::CollisionSurface* const> touchable() const {
        return std::span(settings.surfaces).subspan(rigid_shown ? 0 : rigid_count);
    }

    // Takes the tool towards what is under the pointer.
    void lead_hand() { hand.advance(frame_seconds, pointed_scene(renderer, touchable(), tool_radius, cut)); }

    void move_by_key(const std::string& key) {
        if (orientation && interactor->GetShiftKey()) return tilt_tool(steering(), key);
        if (hand.pressing()) {
            if (key == "w") hand.deepen(key_depth);
            if (key == "s") hand.deepen(-key_depth);
            return;
        }
        step_hand(steering(), key);
    }

    void key_pressed(const char* symbol) {
        std::string key = symbol ? symbol : "";
        if (page_takes_keys) return keys.push_back(key);
        if (key.size() == 1) key[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(key[0])));
        move_by_key(key);
        std::ranges::transform(key, key.begin(), [](unsigned char letter) { return std::tolower(letter); });
        act_on(key);
    }

    // What a key means to the window; `key` is in lower case. Then it is the program's turn.
    void act_on(const std::string& key) {
        static const std::map<std::string, std::function<void(Parts&)>> acts{
            {"c", [](Parts& p) { p.cut = !p.cut; }},
            {"b", [](Parts& p) { p.scene.show_rigid(p.rigid_shown = !p.rigid_shown); }},
            {"t", [](Parts& p) { p.tell(p.layers.turn_regions()); }},
            {"x", [](Parts& p) { p.tell(p.layers.turn_slices()); }},
            {"g", [](Parts& p) { p.tell(p.layers.turn_stiffness()); }},
            {"v", [](Parts& p) { p.endoscope.turn(); }},
            {"u", &Parts::undo_view},
            {"r", &Parts::go_back},
            {"p", [](Parts& p) { p.picture_asked = true; }},
            {"f12", [](Parts& p) { p.picture_asked = true; }},
            {"i", [](Parts& p) { p.overlay.turn_cautions(); }},
            {"h", [](Parts& p) { p.overlay.turn_help(); }},
            {"q", [](Parts& p) { p.closed = true; }},
            {"escape", [](Parts& p) { p.closed = true; }},
            {"plus", [](Parts& p) { p.zoom(1); }},
            {"equal", [](Parts& p) { p.zoom(1); }},
            {"kp_add", [](Parts& p) { p.zoom(1); }},
            {"minus", [](Parts& p) { p.zoom(-1); }},
            {"kp_subtract", [](Parts& p) { p.zoom(-1); }},
        };
        if (const auto act = acts.find(key); act != acts.end()) act->second(*this);
        keys.push_back(key);
    }

    void go_back() {
        keep_view();
        reset();
    }

    void light_buttons(const VisualFrame& frame) {
        buttons.light("c", cut);
        buttons.light("b", rigid_shown);
        buttons.light("t", layers.shows_regions());
        buttons.light("g", layers.shows_stiffness());
        buttons.light("x", layers.shows_slice());
        buttons.light("v", endoscope.on());
        buttons.light("j", frame.jaws_closed.value_or(false));
        buttons.light("o", frame.recording);
        buttons.light("a", frame.audible);
        buttons.light("h", overlay.help_shown());
    }

    // Above the window's own buttons, or in their place where the exercise takes all keys.
    void show_buttons(const LessonView& lesson, bool shown) {
        const int* size = window->GetSize();
        buttons.update(shown && !lesson.takes_keys, size[0], size[1]);
        lesson_buttons.move_to(lesson.takes_keys ? 0 : 1);
        std::vector<ButtonText> texts;
        for (const LessonChoice& action : lesson.actions) texts.push_back({action.key, action.text});
        lesson_buttons.set(texts);
        lesson_buttons.update(shown, size[0], size[1]);
    }

    void tell(const std::string& sentence) {
        if (!sentence.empty()) overlay.tell(sentence);
    }

    std::shared_ptr<OpenedWindow> opened;
    vtkRenderer *renderer = opened->renderer, *front = opened->front;
    vtkRenderWindow* window = opened->window;
    vtkRenderWindowInteractor* interactor = opened->interactor;
    WindowSettings settings;
    PointerHand hand;
    std::optional<Eigen::Quaterniond> orientation;  // as settings have it, of now
    std::size_t rigid_count;
    vtkNew<vtkCallbackCommand> events;
    std::string case_name;
    Scene scene;
    Layers layers;
    ToolShadow shadow;
    Overlay overlay;
    Endoscope endoscope{window, renderer};
    DrawnDetail detail{window, renderer, &scene};
    LessonScene lesson_scene;
    Thumbnails thumbnails;
    LessonPanel panel;
    ButtonBar buttons, lesson_buttons;
    Timeline timeline;
    ViewHistory views;
    std::vector<std::string> keys;  // for take_keys()
    double tool_radius;             // mm
    Vector3d tip = settings.start;  // of the tool as it is drawn, p_P, mm
    bool cut;
    bool rigid_shown = true;
    bool page_takes_keys = false;
    bool hand_stays = false;  // while a recording is looked at
    bool picture_asked = false;
    PictureWriter pictures;
    Drag drag = Drag::none;
    bool closed = false;
    FramePace pace;
    double frame_seconds = 0;  // from picture to picture
};

TrainWindow::TrainWindow(std::shared_ptr<OpenedWindow> opened, const Case& patient_case,
                         const WindowSettings& settings)
    : parts_(std::make_unique<Parts>(std::move(opened), patient_case, settings)) {}

TrainWindow::~TrainWindow() {
    if (lost()) static_cast<void>(parts_.release());
}

void TrainWindow::show(const VisualFrame& frame) {
    speak_to_display([&] { draw(frame); });
}

void TrainWindow::draw(const VisualFrame& frame) {
    Parts& p = *parts_;
    p.interactor->ProcessEvents();
    if (p.closed || lost()) return;
    p.tip = frame.tool_position;
    // Where a fault takes the force away, a press goes no deeper in search of it.
    p.hand.feel(frame.faults == 0 ? frame.force.norm() : std::numeric_limits<double>::infinity(),
                frame.lesson.press_force);
    p.lead_hand();
    p.scene.update(frame);
    p.shadow.update(frame.tool_position, drop_mark(p.touchable(), frame.tool_position, p.tool_radius,
                                                   shadow_share * p.settings.sight.field));
    p.scene.show_inside(p.cut);
    p.look(frame);
    p.overlay.update(frame, frame.film_rate_hz.value_or(frames_per_second()), detail());
    p.page_takes_keys = frame.lesson.takes_keys;
    p.hand_stays = frame.timeline.has_value();
    if (p.hand_stays) p.hand.press(false);
    p.overlay.make_room(frame.lesson.page.has_value(), !frame.lesson.instruction.empty(),
                        frame.lesson.actions.empty() ? 1 : 2);
    p.lesson_scene.update(frame.lesson);
    const int* size = p.window->GetSize();
    p.panel.update(frame.lesson, p.thumbnails, frame.force.norm(), size[0], size[1]);
    p.light_buttons(frame);
    p.show_buttons(frame.lesson, !frame.lesson.page && !frame.film_rate_hz);
    p.timeline.update(frame.timeline);
    p.window->Render();
    if (const auto told = p.pictures.outcome()) p.overlay.tell(*told);
    if (std::exchange(p.picture_asked, false))
        p.detail.with_everything(
            [&] { p.overlay.tell(p.pictures.write(p.window, free_path(".", p.case_name, ".png"))); });
    if (frame.lesson.page && p.pace.frames() > 0)  // the first frame is not to wait for them
        p.thumbnails.take_next(*frame.lesson.page, display_scale(size[0], size[1]));
    const double seconds = p.pace.frame_drawn();
    if (p.pace.frames() < 2) return;
    p.frame_seconds = seconds;
    p.detail.frame_took(frame.film_rate_hz ? 0 : seconds);  // a film has time for everything
}

bool TrainWindow::closed() const {
    return parts_->closed;
}

bool TrainWindow::lost() const {
    return display_lost();
}

void TrainWindow::require_display() const {
    visual::require_display();
}

Vector3d TrainWindow::hand() const {
    return parts_->hand.place();
}

Eigen::Quaterniond TrainWindow::held_orientation() const {
    return parts_->orientation.value_or(Eigen::Quaterniond(0, 0, 0, 0));
}

void TrainWindow::place_hand(const Vector3d& place) {
    parts_->hand.put(place);
}

void TrainWindow::tell(const std::string& sentence) {
    parts_->overlay.tell(sentence);
}

std::vector<std::string> TrainWindow::take_keys() {
    return std::exchange(parts_->keys, {});
}

std::optional<double> TrainWindow::take_sought() {
    return parts_->timeline.take_sought();
}

std::int64_t TrainWindow::frames() const {
    return parts_->pace.frames();
}

double TrainWindow::frames_per_second() const {
    return parts_->pace.per_second();
}

ShownDetail TrainWindow::detail() const {
    const auto& control = parts_->detail.control();
    return control ? ShownDetail{control->level(), control->levels(), control->changes()} : ShownDetail{};
}

void TrainWindow::save_picture(const std::filesystem::path& path) {
    vtkSmartPointer<vtkImageData> pixels;
    speak_to_display([&] { parts_->detail.with_everything([&] { pixels = shown_pixels(parts_->window); }); });
    require_display();
    write_picture(path, pixels);
}

void TrainWindow::add_to(Film& film) {
    vtkSmartPointer<vtkImageData> pixels;
    speak_to_display([&] { pixels = shown_pixels(parts_->window); });
    require_display();
    film.add(pixels);
}

}  // namespace palpate::visual
