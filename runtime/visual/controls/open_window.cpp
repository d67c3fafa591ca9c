// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/open_window.hpp"

#include <cmath>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include "runtime/visual/controls/opened_window.hpp"
#include "runtime/visual/overlay.hpp"

namespace palpate::visual {

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
    text->GetTextProperty()->SetFontFamilyToArial();
    text->GetTextProperty()->SetColor(0.93, 0.95, 0.97);
    text->GetTextProperty()->SetFontSize(
        static_cast<int>(std::lround(points * display_scale(width, height))));
    opened->front->AddActor2D(text);
    opened->interactor->Initialize();  // draws
    opened->front->RemoveActor2D(text);
    survive_loss_of(opened->window->GetGenericDisplayId());
    return opened;
}

}  // namespace palpate::visual
