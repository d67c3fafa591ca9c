// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/readings/stiffness_map.hpp"

#include <algorithm>
#include <cmath>
#include <vector>
#include <vtkFloatArray.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkProperty2D.h>
#include <vtkRenderWindow.h>
#include <vtkTextProperty.h>

#include "runtime/visual/overlay.hpp"
#include "runtime/visual/readings/force_colour.hpp"
#include "runtime/visual/screen_text.hpp"

namespace palpate::visual {
namespace {

constexpr auto stiffness_array = "stiffness";
constexpr int shades = 64;

double percentile(std::vector<float>& values, double share) {
    const auto at = values.begin() + std::lround(share * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, at);
    return static_cast<double>(*at);
}

}  // namespace

StiffnessMap::StiffnessMap(const Case& patient_case, vtkRenderer* front) : front_(front) {
    std::vector<float> pressed;
    for (const DeformableBody& body : patient_case.deformable_bodies)
        if (body.feel)
            std::ranges::copy_if(body.feel->stiffness, std::back_inserter(pressed),
                                 [](float k) { return k > 0; });
    empty_ = pressed.empty();
    colours_->SetNumberOfTableValues(shades);
    for (int i = 0; i < shades; ++i) {
        const Rgb colour = force_colour(static_cast<double>(i) / (shades - 1)) / 255;
        colours_->SetTableValue(i, colour[0], colour[1], colour[2]);
    }
    colours_->SetNanColor(0.5, 0.5, 0.5, 1);
    if (!empty_) colours_->SetTableRange(percentile(pressed, 0.05), percentile(pressed, 0.95));
    scale_->SetLookupTable(colours_);
    scale_->SetTitle("N/mm");
    scale_->SetVerticalTitleSeparation(8);
    scale_->SetNumberOfLabels(5);
    scale_->SetLabelFormat("%.3g");
    scale_->UnconstrainedFontSizeOn();
    scale_->SetPosition(0.017, 0.2);
    scale_->SetWidth(0.075);
    scale_->SetHeight(0.36);
    scale_->DrawBackgroundOn();
    scale_->GetBackgroundProperty()->SetColor(0.05, 0.07, 0.09);
    scale_->GetBackgroundProperty()->SetOpacity(0.55);
    for (vtkTextProperty* text : {scale_->GetTitleTextProperty(), scale_->GetLabelTextProperty()}) {
        dress(text, 0);
        text->ItalicOff();
        text->ShadowOff();
        text->BoldOff();
    }
    scale_->VisibilityOff();
    front->AddActor2D(scale_);
}

vtkSmartPointer<vtkActor> StiffnessMap::actor_of(const DeformableBody& body, vtkPolyData* data) const {
    if (!body.feel) return nullptr;
    vtkNew<vtkFloatArray> values;
    values->SetName(stiffness_array);
    for (const float stiffness : body.feel->stiffness)
        values->InsertNextValue(stiffness > 0 ? stiffness : std::nanf(""));
    data->GetPointData()->AddArray(values);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    mapper->SetScalarModeToUsePointFieldData();
    mapper->SelectColorArray(stiffness_array);
    mapper->SetLookupTable(colours_);
    mapper->UseLookupTableScalarRangeOn();
    mapper->InterpolateScalarsBeforeMappingOn();
    auto drawn = vtkSmartPointer<vtkActor>::New();
    drawn->SetMapper(mapper);
    drawn->GetProperty()->SetAmbient(0.25);
    drawn->GetProperty()->SetDiffuse(0.75);
    return drawn;
}

void StiffnessMap::show(bool on) {
    scale_->SetVisibility(on);
}

void StiffnessMap::fit() {
    constexpr double points = 14;  // in a window of 1280x720
    const int* size = front_->GetVTKWindow()->GetSize();
    const auto font = static_cast<int>(std::lround(points * display_scale(size[0], size[1])));
    for (vtkTextProperty* text : {scale_->GetTitleTextProperty(), scale_->GetLabelTextProperty()})
        text->SetFontSize(font);
}

}  // namespace palpate::visual
