// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <vtkImageData.h>
#include <vtkRenderWindow.h>
#include <vtkSmartPointer.h>

namespace palpate::visual {

/// The picture that the window drew last. Where speak_to_display() runs.
vtkSmartPointer<vtkImageData> shown_pixels(vtkRenderWindow* window);

/// Writes pixels as PNG. Throws SystemFailure if that fails. In any thread; up to a second for 3840x2160.
void write_picture(const std::filesystem::path& path, vtkImageData* pixels);

/// Writes pictures of a window beside its loop: compressing a large one takes up to a second, for which the
/// window must not stand still.
class PictureWriter {
  public:
    /// Begins to write the picture that the window drew last. What to say of it. Where speak_to_display()
    /// runs.
    std::string write(vtkRenderWindow* window, const std::filesystem::path& path);
    /// Once, when a picture is there or has failed: what to say of it.
    std::optional<std::string> outcome();

  private:
    std::future<std::string> writing_;
};

}  // namespace palpate::visual
