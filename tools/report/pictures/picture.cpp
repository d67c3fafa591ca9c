// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/pictures/picture.hpp"

#include <algorithm>
#include <cmath>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>
#include <vtkUnsignedCharArray.h>

namespace palpate::report {

Picture shrunk(const Picture& picture, int factor) {
    Picture small{picture.width / factor, picture.height / factor, {}};
    small.rgb.resize(small.offset(0, small.height));
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x)
            for (std::size_t channel = 0; channel < 3; ++channel) {
                int sum = 0;
                for (int i = 0; i < factor * factor; ++i)
                    sum +=
                        picture
                            .rgb[picture.offset(factor * x + i % factor, factor * y + i / factor) + channel];
                small.rgb[small.offset(x, y) + channel] = static_cast<std::uint8_t>(sum / (factor * factor));
            }
    return small;
}

Rgb rgb_of(const std::array<float, 3>& colour) {
    Rgb rgb{};
    for (std::size_t c = 0; c < 3; ++c)
        rgb[c] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(colour[c], 0.0F, 1.0F)));
    return rgb;
}

Picture blank(int width, int height, const Rgb& colour) {
    Picture picture{width, height, {}};
    picture.rgb.resize(picture.offset(0, height));
    fill(picture, 0, 0, width, height, colour);
    return picture;
}

void paste(Picture& onto, const Picture& picture, int x, int y) {
    for (int row = std::max(0, -y); row < std::min(picture.height, onto.height - y); ++row)
        for (int column = std::max(0, -x); column < std::min(picture.width, onto.width - x); ++column)
            std::copy_n(picture.rgb.data() + picture.offset(column, row), 3,
                        onto.rgb.data() + onto.offset(x + column, y + row));
}

void fill(Picture& onto, int x, int y, int width, int height, const Rgb& colour) {
    for (int row = std::max(0, y); row < std::min(y + height, onto.height); ++row)
        for (int column = std::max(0, x); column < std::min(x + width, onto.width); ++column)
            std::copy_n(colour.data(), 3, onto.rgb.data() + onto.offset(column, row));
}

void write_words(Picture& onto, int x, int y, const std::string& text, int size, const Rgb& colour) {
    if (text.empty()) return;
    vtkNew<vtkTextProperty> face;
    face->SetFontFamilyToArial();
    face->SetFontSize(size);
    face->SetColor(1, 1, 1);
    face->SetVerticalJustificationToTop();
    vtkNew<vtkImageData> image;  // RGBA, rows from the bottom, larger than its text
    std::array<int, 2> used{};
    constexpr int dpi = 72;  // a point is a pixel
    if (!vtkTextRenderer::GetInstance()->RenderString(face, text, image, used.data(), dpi)) return;
    for (int row = 0; row < used[1]; ++row)
        for (int column = 0; column < used[0]; ++column) {
            const int at_x = x + column, at_y = y + row;
            if (at_x < 0 || at_y < 0 || at_x >= onto.width || at_y >= onto.height) continue;
            const auto* extent = image->GetExtent();
            const auto* pixel = static_cast<const std::uint8_t*>(
                image->GetScalarPointer(extent[0] + column, extent[2] + used[1] - 1 - row, 0));
            std::uint8_t* under = onto.rgb.data() + onto.offset(at_x, at_y);
            for (std::size_t c = 0; c < 3; ++c)
                under[c] =
                    static_cast<std::uint8_t>((pixel[3] * colour[c] + (255 - pixel[3]) * under[c]) / 255);
        }
}

std::string png_bytes(const Picture& picture) {
    vtkNew<vtkImageData> image;
    image->SetDimensions(picture.width, picture.height, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    // VTK counts rows from the bottom.
    for (int y = 0; y < picture.height; ++y)
        std::copy_n(picture.rgb.data() + picture.offset(0, y), 3 * picture.width,
                    static_cast<std::uint8_t*>(image->GetScalarPointer(0, picture.height - 1 - y, 0)));
    vtkNew<vtkPNGWriter> writer;
    writer->SetInputData(image);
    writer->WriteToMemoryOn();
    writer->Write();
    vtkUnsignedCharArray* bytes = writer->GetResult();
    return {reinterpret_cast<const char*>(bytes->GetPointer(0)),
            static_cast<std::size_t>(bytes->GetNumberOfTuples())};
}

}  // namespace palpate::report
