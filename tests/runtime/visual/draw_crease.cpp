// SPDX-License-Identifier: Apache-2.0
// Draws a right-angled groove under even light in a window, as it is and with ambient occlusion, and prints
// how bright it is, 0 to 255, at its bottom and far from it: a row for each, then who drew: software or
// hardware.
#include <Eigen/Core>
#include <iostream>
#include <vtkCamera.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include "runtime/visual/actors.hpp"
#include "runtime/visual/detail/occlusion.hpp"
#include "runtime/visual/pictures.hpp"

namespace {

// Two walls, 40 mm long and 20 mm high, that meet along the y axis, seen from above.
palpate::TriangleMesh groove() {
    return {{{-20, -20, 20}, {0, -20, 0}, {20, -20, 20}, {-20, 20, 20}, {0, 20, 0}, {20, 20, 20}},
            {{0, 1, 3}, {1, 4, 3}, {1, 2, 4}, {2, 5, 4}}};
}

}  // namespace

int main() {
    using namespace palpate;
    const auto walls = visual::actor(visual::poly_data(groove(), {0, 0, 1}), {200, 200, 200});
    walls->GetProperty()->SetAmbient(1);  // the same light everywhere
    walls->GetProperty()->SetDiffuse(0);
    walls->GetProperty()->SetSpecular(0);
    vtkNew<vtkRenderer> renderer;
    renderer->AddActor(walls);
    renderer->GetActiveCamera()->SetPosition(0, 0, 100);
    renderer->GetActiveCamera()->SetFocalPoint(0, 0, 0);
    renderer->GetActiveCamera()->SetViewUp(0, 1, 0);
    renderer->ResetCameraClippingRange();
    vtkNew<vtkRenderWindow> window;
    window->SetMultiSamples(0);
    window->SetSize(200, 200);
    window->AddRenderer(renderer);
    for (const bool occlusion : {false, true}) {
        renderer->SetPass(occlusion ? visual::occlusion_pass(renderer) : nullptr);
        window->Render();
        const auto pixels = visual::shown_pixels(window);
        const auto bright = [&](int x) { return pixels->GetScalarComponentAsDouble(x, 100, 0, 0); };
        std::cout << bright(100) << " " << bright(40) << "\n";
    }
    std::cout << (visual::drawn_by_hardware(window) ? "hardware" : "software") << "\n";
    return 0;
}
