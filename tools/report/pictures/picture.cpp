// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/pictures/picture.hpp"

#include <algorithm>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
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
