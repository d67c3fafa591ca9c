// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/pictures.hpp"

#include <string_view>
#include <system_error>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkWindowToImageFilter.h>

#include "formats/model/errors.hpp"

namespace palpate::visual {

std::filesystem::path free_picture_path(const std::filesystem::path& folder, const std::string& case_name) {
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
    std::string name = case_name;
    for (char& c : name)
        if (plain.find(c) == std::string_view::npos) c = '_';
    for (int n = 1;; ++n) {
        const auto path = folder / ("palpate-" + name + "-" + std::to_string(n) + ".png");
        std::error_code nothing_to_see;
        if (!std::filesystem::exists(path, nothing_to_see)) return path;
    }
}

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
