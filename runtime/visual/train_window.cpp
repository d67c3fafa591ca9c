// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/train_window.hpp"

#include <Eigen/Geometry>
#include <X11/Xlib.h>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkWindowToImageFilter.h>

#include "formats/model/errors.hpp"
#include "runtime/visual/endoscope.hpp"
#include "runtime/visual/lesson_panel.hpp"
#include "runtime/visual/lesson_scene.hpp"
#include "runtime/visual/overlay.hpp"
#include "runtime/visual/scene.hpp"

namespace palpate::visual {
namespace {

using Eigen::Vector3d;

constexpr double view_angle_deg = 30;
constexpr double step = 0.5;          // mm a key press
constexpr double wheel_step = 1;      // mm a notch
constexpr double zoom_step = 1.15;    // a key press
constexpr double turn_deg = 0.35;     // a pixel
constexpr double clear_share = 0.04;  // of the field: what a cut leaves before the target
constexpr double clear_radii = 3;     // tool radii that a cut leaves before the tool

// A connection of our own: VTK aborts where no display answers, and a server that loses its last client
// between a test and the window would start anew.
struct DisplayConnection {
    DisplayConnection() : display(XOpenDisplay(nullptr)) {
        if (display == nullptr)
            throw SystemFailure(
                {.culprit = "DISPLAY",
                 .found = "no X display answers, and the window needs one",
                 .expected = "",
                 .next_step = "log in to a desktop, set DISPLAY, or try 'xvfb-run palpate train ...'"});
    }
    DisplayConnection(const DisplayConnection&) = delete;
    DisplayConnection& operator=(const DisplayConnection&) = delete;
    ~DisplayConnection() { XCloseDisplay(display); }
    Display* display;
};

}  // namespace

struct TrainWindow::Parts {
    Parts(const Case& patient_case, const WindowSettings& window_settings)
        : settings(window_settings),
          hand(window_settings.start),
          scene(patient_case, window_settings.sight, window_settings.rigid_budget, renderer, front),
          overlay(patient_case.name, patient_case.haptics.max_force, window_settings.cautions, front),
          lesson_scene(renderer),
          panel(front),
          tool_radius(patient_case.haptics.tool_radius),
          cut(window_settings.sight.blocked) {
        renderer->GradientBackgroundOn();
        renderer->SetBackground(0.07, 0.09, 0.11);
        renderer->SetBackground2(0.20, 0.25, 0.30);
        window->SetNumberOfLayers(2);
        front->SetLayer(1);
        window->AddRenderer(renderer);
        window->AddRenderer(front);
        window->SetSize(settings.width, settings.height);
        window->SetWindowName(("Palpate: " + patient_case.name).c_str());
        window->SetMultiSamples(0);  // software rendering pays for every sample
        interactor->SetRenderWindow(window);
        interactor->SetInteractorStyle(nullptr);
        events->SetClientData(this);
        events->SetCallback([](vtkObject*, unsigned long event, void* self, void*) {
            static_cast<Parts*>(self)->handle(event);
        });
        for (const unsigned long event :
             {vtkCommand::LeftButtonPressEvent, vtkCommand::LeftButtonReleaseEvent,
              vtkCommand::RightButtonPressEvent, vtkCommand::RightButtonReleaseEvent,
              vtkCommand::MouseMoveEvent, vtkCommand::MouseWheelForwardEvent,
              vtkCommand::MouseWheelBackwardEvent, vtkCommand::KeyPressEvent, vtkCommand::ExitEvent})
            interactor->AddObserver(event, events);
        reset();
        interactor->Initialize();
    }

    void reset() {
        hand = settings.start;
        const Vector3d eye = settings.sight.eye(view_angle_deg);
        vtkCamera* camera = renderer->GetActiveCamera();
        camera->SetViewAngle(view_angle_deg);
        camera->SetFocalPoint(settings.sight.focus.data());
        camera->SetPosition(eye.data());
        const Vector3d up = settings.sight.axes().col(1);
        camera->SetViewUp(up.data());
        camera->OrthogonalizeViewUp();
    }

    // Unit directions of the view: to the right, up, towards the eye.
    std::array<Vector3d, 3> view_axes() {
        vtkCamera* camera = renderer->GetActiveCamera();
        camera->OrthogonalizeViewUp();
        const Vector3d eye = -Vector3d(camera->GetDirectionOfProjection());
        const Vector3d up = Vector3d(camera->GetViewUp());
        return {up.cross(eye), up, eye};
    }

    // Millimetres in the view plane through the hand that one pixel spans.
    double pixel_size() {
        vtkCamera* camera = renderer->GetActiveCamera();
        const double distance = std::abs((Vector3d(camera->GetPosition()) - hand).dot(view_axes()[2]));
        return 2 * distance * std::tan(camera->GetViewAngle() * std::numbers::pi / 360) /
               window->GetSize()[1];
    }

    void look(const VisualFrame& frame) {
        scene.show_tool(!endoscope.on());
        if (endoscope.on())
            endoscope.follow(frame.tool_position, frame.lesson.look_at, tool_radius,
                             renderer->GetActiveCamera());
        else
            set_clipping_range(frame.tool_position);
    }

    // With the cut on, whatever stands between eye and target or tool falls before the near plane.
    // Rasterisers clip there for nothing, where clipping in a shader costs a third of the frames.
    void set_clipping_range(const Vector3d& tool) {
        renderer->ResetCameraClippingRange();
        front->GetActiveCamera()->DeepCopy(renderer->GetActiveCamera());
        front->ResetCameraClippingRange();
        if (!cut) return;
        vtkCamera* camera = renderer->GetActiveCamera();
        const Vector3d eye = view_axes()[2];
        const auto distance = [&](const Vector3d& p) { return eye.dot(Vector3d(camera->GetPosition()) - p); };
        const double near = std::min(distance(settings.sight.target) - clear_share * settings.sight.field,
                                     distance(tool) - clear_radii * tool_radius);
        const double far = camera->GetClippingRange()[1];
        camera->SetClippingRange(std::max(near, 1e-3 * far), far);
    }

    void handle(unsigned long event) {
        switch (event) {
            case vtkCommand::LeftButtonPressEvent:
                if (!choose_on_page()) dragging = true;
                break;
            case vtkCommand::LeftButtonReleaseEvent:
                dragging = false;
                break;
            case vtkCommand::RightButtonPressEvent:
                turning = true;
                break;
            case vtkCommand::RightButtonReleaseEvent:
                turning = false;
                break;
            case vtkCommand::MouseMoveEvent:
                pointer_moved();
                break;
            case vtkCommand::MouseWheelForwardEvent:
                hand -= view_axes()[2] * wheel_step;
                break;
            case vtkCommand::MouseWheelBackwardEvent:
                hand += view_axes()[2] * wheel_step;
                break;
            case vtkCommand::KeyPressEvent:
                key_pressed(interactor->GetKeySym());
                break;
            default:
                closed = true;
                break;
        }
    }

    // Whether the pointer was on a choice of a page, which is taken then.
    bool choose_on_page() {
        const int* at = interactor->GetEventPosition();
        std::string choice = panel.choice_at(at[0], at[1]);
        if (choice.empty()) return false;
        keys.push_back(std::move(choice));
        return true;
    }

    void pointer_moved() {
        const int* now = interactor->GetEventPosition();
        panel.hover(now[0], now[1]);
        const int* before = interactor->GetLastEventPosition();
        const double dx = now[0] - before[0], dy = now[1] - before[1];
        if (dragging) {
            const auto [right, up, eye] = view_axes();
            hand += (right * dx + up * dy) * pixel_size();
        } else if (turning) {
            vtkCamera* camera = renderer->GetActiveCamera();
            camera->Azimuth(-turn_deg * dx);
            camera->Elevation(-turn_deg * dy);
            camera->OrthogonalizeViewUp();
        }
    }

    void key_pressed(const char* symbol) {
        std::string key = symbol ? symbol : "";
        if (key.size() == 1) key[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(key[0])));
        const auto [right, up, eye] = view_axes();
        const std::map<std::string, Vector3d> moves{{"Left", -right}, {"Right", right}, {"Up", up},
                                                    {"Down", -up},    {"w", -eye},      {"s", eye}};
        if (const auto move = moves.find(key); move != moves.end()) hand += step * move->second;
        if (key == "plus" || key == "equal" || key == "KP_Add") renderer->GetActiveCamera()->Dolly(zoom_step);
        if (key == "minus" || key == "KP_Subtract") renderer->GetActiveCamera()->Dolly(1 / zoom_step);
        if (key == "c") cut = !cut;
        if (key == "b") scene.show_rigid(rigid_shown = !rigid_shown);
        if (key == "h") overlay.show_help(help_shown = !help_shown);
        if (key == "i") overlay.turn_cautions();
        if (key == "r") reset();
        if (key == "v") endoscope.turn(renderer->GetActiveCamera());
        if (key == "q" || key == "Escape") closed = true;
        std::ranges::transform(key, key.begin(), [](unsigned char letter) { return std::tolower(letter); });
        keys.push_back(key);
    }

    DisplayConnection display;
    WindowSettings settings;
    Vector3d hand;
    vtkNew<vtkRenderer> renderer, front;
    vtkNew<vtkRenderWindow> window;
    vtkNew<vtkRenderWindowInteractor> interactor;
    vtkNew<vtkCallbackCommand> events;
    Scene scene;
    Overlay overlay;
    Endoscope endoscope;
    LessonScene lesson_scene;
    LessonPanel panel;
    std::vector<std::string> keys;  // for take_keys()
    double tool_radius;             // mm
    bool cut;
    bool rigid_shown = true;
    bool help_shown = true;
    bool dragging = false;
    bool turning = false;
    bool closed = false;
    std::int64_t frames = 0;
    double frame_seconds = 0;  // of a frame, averaged over some thirty
    std::chrono::steady_clock::time_point last_frame{};
};

TrainWindow::TrainWindow(const Case& patient_case, const WindowSettings& settings)
    : parts_(std::make_unique<Parts>(patient_case, settings)) {}

TrainWindow::~TrainWindow() = default;

void TrainWindow::show(const VisualFrame& frame) {
    Parts& p = *parts_;
    p.interactor->ProcessEvents();
    if (p.closed) return;
    p.scene.update(frame);
    p.scene.show_inside(p.cut);
    p.look(frame);
    p.overlay.update(frame, frames_per_second());
    p.overlay.make_room(frame.lesson.page.has_value(), !frame.lesson.instruction.empty());
    p.lesson_scene.update(frame.lesson);
    p.panel.update(frame.lesson, frame.force.norm(), p.window->GetSize()[0], p.window->GetSize()[1]);
    p.window->Render();
    ++p.frames;
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - p.last_frame).count();
    p.last_frame = now;
    if (p.frames == 2) p.frame_seconds = seconds;
    if (p.frames > 2) p.frame_seconds += (seconds - p.frame_seconds) / 30;
}

bool TrainWindow::closed() const {
    return parts_->closed;
}

Vector3d TrainWindow::hand() const {
    return parts_->hand;
}

void TrainWindow::place_hand(const Vector3d& place) {
    parts_->hand = place;
}

std::vector<std::string> TrainWindow::take_keys() {
    return std::exchange(parts_->keys, {});
}

std::int64_t TrainWindow::frames() const {
    return parts_->frames;
}

double TrainWindow::frames_per_second() const {
    return parts_->frame_seconds > 0 ? 1 / parts_->frame_seconds : 0;
}

void TrainWindow::save_picture(const std::filesystem::path& path) {
    vtkNew<vtkWindowToImageFilter> grab;
    grab->SetInput(parts_->window);
    grab->ReadFrontBufferOff();
    vtkNew<vtkPNGWriter> writer;
    writer->SetInputConnection(grab->GetOutputPort());
    writer->SetFileName(path.c_str());
    writer->Write();
    if (writer->GetErrorCode() != 0)
        throw SystemFailure(
            {path.string(), "the picture could not be written", "", "check free space and permissions"});
}

}  // namespace palpate::visual
