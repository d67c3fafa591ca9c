// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/tissue/tissue_actor.hpp"

#include <fmt/format.h>
#include <string>
#include <vtkDataObject.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkOpenGLPolyDataMapper.h>
#include <vtkPointData.h>
#include <vtkProperty.h>
#include <vtkShaderProperty.h>

namespace palpate::visual {
namespace {

using Eigen::Array3d;

// Waves that bend each other: no two places look alike, at a fraction of what tabled noise costs. -1 ... 1.
double blotch(const Array3d& p) {
    const Array3d bend = (0.47 * Array3d(p[2], p[0], p[1])).sin();
    const Array3d wave = (0.83 * Array3d(p[1], p[2], p[0]) + 1.9 * bend).sin();
    return (wave[0] * wave[1] + wave[1] * wave[2] + wave[2] * wave[0]) / 3;
}

constexpr auto shade_array = "tissueShade";

// Blotches of two sizes, one factor a point: they cost little to draw.
void add_shades(vtkPolyData* data, double grain) {
    constexpr double coarse = 0.22, fine = 0.12, coarse_grains = 7, fine_grains = 1.7;
    vtkNew<vtkFloatArray> shades;
    shades->SetName(shade_array);
    shades->SetNumberOfTuples(data->GetNumberOfPoints());
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
        Array3d p;
        data->GetPoint(i, p.data());
        p /= grain;
        shades->SetValue(
            i, static_cast<float>(1 + coarse * blotch(p / coarse_grains) + fine * blotch(p / fine_grains)));
    }
    data->GetPointData()->AddArray(shades);
}

// The waves of blotch() again, for what is finer than triangles; they bend the normal too. Where waves of two
// sizes pass through zero run vessels, those of the smaller ones thinner; what is dry shows none.
void roughen(vtkActor* actor, double grain, double wetness) {
    constexpr double mottle = 0.045;
    const double bump = 0.05 * wetness, vessels = 0.8 * wetness;
    vtkShaderProperty* shader = actor->GetShaderProperty();
    shader->AddVertexShaderReplacement(
        "//VTK::Normal::Dec", true,
        "//VTK::Normal::Dec\nin float tissueShade;\nout float tissueShadeVS;\nout vec3 tissuePlaceVS;\n",
        false);
    shader->AddVertexShaderReplacement(
        "//VTK::Normal::Impl", true,
        fmt::format("//VTK::Normal::Impl\n  tissueShadeVS = tissueShade;\n"
                    "  tissuePlaceVS = vertexMC.xyz * {:.6f} + vec3(23.0, -17.0, 11.0) * tissueShade;\n",
                    1 / grain),
        false);
    shader->AddFragmentShaderReplacement(
        "//VTK::Normal::Dec", true, "//VTK::Normal::Dec\nin float tissueShadeVS;\nin vec3 tissuePlaceVS;\n",
        false);
    shader->AddFragmentShaderReplacement(
        "//VTK::Color::Impl", true,
        fmt::format("//VTK::Color::Impl\n"
                    "  vec3 bend = sin(tissuePlaceVS.yzx * 0.83 + 1.9 * sin(tissuePlaceVS.zxy * 0.47));\n"
                    "  vec3 wave = sin(tissuePlaceVS + 1.6 * bend);\n"
                    "  vec3 spots = wave * wave.yzx;\n"
                    "  diffuseColor *= tissueShadeVS + {:.6f} * (spots.x + spots.y + spots.z);\n"
                    "  ambientColor *= tissueShadeVS;\n"
                    "  vec3 p = tissuePlaceVS - vec3(23.0, -17.0, 11.0) * tissueShadeVS;\n"
                    "  vec3 large = 0.11 * p + 0.5 * sin(0.21 * p.yzx) + 0.13 * sin(0.61 * p.zxy);\n"
                    "  vec3 small = 0.29 * p.zxy + 0.6 * sin(0.41 * p) + 0.13 * sin(0.97 * p.yzx);\n"
                    "  float trunk = abs(sin(large.x) + sin(large.y) + sin(large.z));\n"
                    "  float branch = abs(sin(small.x) + sin(small.y) + sin(small.z));\n"
                    "  float vessel = max(1.0 - smoothstep(0.05, 0.20, trunk),\n"
                    "                     0.6 - 0.6 * smoothstep(0.05, 0.24, branch));\n"
                    "  diffuseColor *= mix(vec3(1.0), vec3(0.62, 0.45, 0.60), {:.6f} * vessel);\n",
                    mottle, vessels),
        false);
    shader->AddFragmentShaderReplacement(
        "//VTK::Normal::Impl", true,
        fmt::format("//VTK::Normal::Impl\n"
                    "  normalVCVSOutput = normalize(normalVCVSOutput + {:.6f} * spots);\n",
                    bump),
        false);
}

}  // namespace

vtkSmartPointer<vtkActor> tissue_actor(vtkPolyData* data, const TissueLook& look) {
    auto result = actor(data, look.colour);
    vtkProperty* front = result->GetProperty();
    front->SetAmbient(0.16);
    front->SetDiffuse(0.9);
    front->SetSpecular(0.8 * look.wetness);
    front->SetSpecularColor(1, 0.97, 0.94);
    front->SetSpecularPower(25 + 70 * look.wetness);
    vtkNew<vtkProperty> back;
    constexpr float inside = 0.7F;
    back->SetColor(inside * look.colour[0] / 255, inside * look.colour[1] / 255,
                   inside * look.colour[2] / 255);
    back->SetAmbient(1);
    back->SetDiffuse(0);
    result->SetBackfaceProperty(back);
    return result;
}

vtkSmartPointer<vtkActor> grained_tissue_actor(vtkPolyData* data, const TissueLook& look, double grain) {
    add_shades(data, grain);
    auto result = tissue_actor(data, look);
    auto* mapper = vtkOpenGLPolyDataMapper::SafeDownCast(result->GetMapper());
    mapper->SetVBOShiftScaleMethod(0);  // places stay in mm on their way to the shader
    mapper->MapDataArrayToVertexAttribute(shade_array, shade_array, vtkDataObject::FIELD_ASSOCIATION_POINTS);
    roughen(result, grain, look.wetness);
    return result;
}

}  // namespace palpate::visual
