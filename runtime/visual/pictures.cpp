// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/pictures.hpp"

#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkWindowToImageFilter.h>

#include "formats/model/errors.hpp"

namespace palpate::visual {

vtkSmartPointer<vtkImageData> grab_pixels(vtkRenderWindow* window) {
    vtkNew<vtkWindowToImageFilter> grab;
    grab->SetInput(window);
    grab->ReadFrontBufferOff();
    grab->Update();
    return grab->GetOutput();
}

void write_picture(const std::filesystem::path& path, vtkImageData* pixels) {
    vtkNew<vtkPNGWriter> writer;
    writer->SetInputData(pixels);
    writer->SetFileName(path.c_str());
    writer->Write();
    if (writer->GetErrorCode() != 0)
        throw SystemFailure(
            {path.string(), "the picture could not be written", "", "check free space and permissions"});
}

}  // namespace palpate::visual
