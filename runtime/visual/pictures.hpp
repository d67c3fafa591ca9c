// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <vtkImageData.h>
#include <vtkRenderWindow.h>
#include <vtkSmartPointer.h>

namespace palpate::visual {

/// What the window shows. In the thread that draws it.
vtkSmartPointer<vtkImageData> grab_pixels(vtkRenderWindow* window);

/// Writes pixels as PNG. Throws SystemFailure if that fails. In any thread; up to a second for 3840x2160.
void write_picture(const std::filesystem::path& path, vtkImageData* pixels);

}  // namespace palpate::visual
