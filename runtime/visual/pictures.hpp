// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vtkImageData.h>
#include <vtkRenderWindow.h>
#include <vtkSmartPointer.h>

namespace palpate::visual {

/// The first path "palpate-CASE-N.png" in `folder`, N = 1, 2, ..., at which nothing is yet. What is neither
/// letter, digit, hyphen nor underscore in the case's name becomes an underscore.
std::filesystem::path free_picture_path(const std::filesystem::path& folder, const std::string& case_name);

/// What the window shows. In the thread that draws it.
vtkSmartPointer<vtkImageData> grab_pixels(vtkRenderWindow* window);

/// Writes pixels as PNG. Throws SystemFailure if that fails. In any thread; up to a second for 3840x2160.
void write_picture(const std::filesystem::path& path, vtkImageData* pixels);

}  // namespace palpate::visual
