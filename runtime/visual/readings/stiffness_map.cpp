// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/readings/stiffness_map.hpp"

#include <algorithm>
#include <cmath>
#include <vector>
#include <vtkFloatArray.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include "runtime/visual/readings/force_colour.hpp"

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

StiffnessMap::StiffnessMap(const Case& patient_case, vtkRenderer* front)
    : scale_(colours_, "N/mm", 0.017, front) {
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

}  // namespace palpate::visual
