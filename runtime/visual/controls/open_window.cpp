// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/open_window.hpp"

#include <algorithm>
#include <cmath>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include "runtime/visual/controls/opened_window.hpp"
#include "runtime/visual/overlay.hpp"
#include "runtime/visual/screen_text.hpp"

namespace palpate::visual {

WindowSize usual_window_size(int display_width, int display_height) {
    const double scale = std::max(1.0, std::min(display_width / 1920.0, display_height / 1080.0));
    return {std::min(display_width, static_cast<int>(1280 * scale)),
            std::min(display_height, static_cast<int>(720 * scale))};
}

std::shared_ptr<OpenedWindow> open_window(const std::optional<WindowSize>& size,
                                          const std::string& sentence) {
    constexpr double points = 20;  // in a window of 1280x720
    auto opened = std::make_shared<OpenedWindow>();
    const int* display = opened->window->GetScreenSize();
    const auto [width, height] = size.value_or(usual_window_size(display[0], display[1]));
    opened->renderer->SetBackground(0.10, 0.13, 0.16);  // a gradient takes a twentieth of a frame
    opened->front->SetLayer(1);
    opened->window->SetNumberOfLayers(2);
    opened->window->AddRenderer(opened->renderer);
    opened->window->AddRenderer(opened->front);
    opened->window->SetSize(width, height);
    opened->window->SetWindowName("Palpate");
    opened->window->SetMultiSamples(0);  // software rendering pays for every sample
    opened->interactor->SetRenderWindow(opened->window);
    opened->interactor->SetInteractorStyle(nullptr);

    vtkNew<vtkTextActor> text;
    text->SetInput(sentence.c_str());
    text->SetPosition(width / 2.0, height / 2.0);
    text->GetTextProperty()->SetJustificationToCentered();
    dress(text->GetTextProperty(), 0);
    text->GetTextProperty()->SetFontSize(
        static_cast<int>(std::lround(points * display_scale(width, height))));
    opened->front->AddActor2D(text);
    opened->interactor->Initialize();  // draws
    opened->front->RemoveActor2D(text);
    survive_loss_of(opened->window->GetGenericDisplayId());
    return opened;
}

}  // namespace palpate::visual
