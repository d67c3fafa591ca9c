// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/detail/occlusion.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <vtkBoundingBox.h>
#include <vtkNew.h>
#include <vtkRenderStepsPass.h>
#include <vtkSSAOPass.h>
#include <vtkTranslucentPass.h>

namespace palpate::visual {

vtkSmartPointer<vtkRenderPass> occlusion_pass(vtkRenderer* renderer) {
    constexpr double reach_share = 1.0 / 16, bias_share = 1.0 / 50;  // of the scene; of the reach
    vtkNew<vtkTranslucentPass> translucent;                          // as CoarsePixels has it
    vtkNew<vtkRenderStepsPass> steps;
    steps->SetTranslucentPass(translucent);
    const double reach =
        reach_share * vtkBoundingBox(renderer->ComputeVisiblePropBounds()).GetDiagonalLength();
    auto pass = vtkSmartPointer<vtkSSAOPass>::New();
    pass->SetDelegatePass(steps);
    pass->SetRadius(reach);
    pass->SetBias(bias_share * reach);
    pass->SetKernelSize(64);
    pass->BlurOn();
    return pass;
}

bool drawn_by_hardware(vtkRenderWindow* window) {
    const std::string_view told = window->ReportCapabilities();
    constexpr std::array<std::string_view, 4> in_software{"llvmpipe", "softpipe", "swrast", "SWR"};
    return std::ranges::none_of(
        in_software, [&](std::string_view name) { return told.find(name) != std::string_view::npos; });
}

}  // namespace palpate::visual
