// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/pictures.hpp"

#include <chrono>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkWindowToImageFilter.h>

#include "formats/model/errors.hpp"
#include "runtime/texts/translated.hpp"

namespace palpate::visual {

vtkSmartPointer<vtkImageData> shown_pixels(vtkRenderWindow* window) {
    vtkNew<vtkWindowToImageFilter> grab;
    grab->SetInput(window);
    grab->ReadFrontBufferOff();
    grab->ShouldRerenderOff();  // it is drawn
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

std::string PictureWriter::write(vtkRenderWindow* window, const std::filesystem::path& path) {
    if (writing_.valid()) return texts::translated("the last picture is still being written");
    writing_ = std::async(std::launch::async, [path, pixels = shown_pixels(window)]() -> std::string {
        try {
            write_picture(path, pixels);
            return texts::translated("picture: {}", path.filename().string());
        } catch (const SystemFailure& failure) {
            return failure.what();
        }
    });
    return texts::translated("writing {}", path.filename().string());
}

std::optional<std::string> PictureWriter::outcome() {
    using namespace std::chrono_literals;
    if (!writing_.valid() || writing_.wait_for(0s) != std::future_status::ready) return std::nullopt;
    return writing_.get();
}

}  // namespace palpate::visual
