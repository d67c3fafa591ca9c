// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: the two image types that ITK filters see here, and the way to and from plain values.
#pragma once
#include <Eigen/Dense>
#include <itkImage.h>
#include <span>
#include <string>

#include "formats/model/image_grid.hpp"

namespace palpate::imaging {

template <typename Voxel>
using ItkImage = itk::Image<Voxel, 3>;

/// Copies voxels into an ITK image with the geometry of `grid`.
template <typename Voxel>
typename ItkImage<Voxel>::Pointer to_itk(const ImageGrid& grid, std::span<const Voxel> voxels) {
    auto image = ItkImage<Voxel>::New();
    itk::Size<3> size;
    itk::Matrix<double, 3, 3> direction;
    for (unsigned row = 0; row < 3; ++row) {
        size[row] = static_cast<itk::SizeValueType>(grid.size[row]);
        for (unsigned column = 0; column < 3; ++column) direction(row, column) = grid.direction(row, column);
    }
    image->SetRegions(size);
    image->SetSpacing(grid.spacing.data());
    image->SetOrigin(grid.origin.data());
    image->SetDirection(direction);
    image->Allocate();
    std::ranges::copy(voxels, image->GetBufferPointer());
    return image;
}

/// The voxels of an ITK image, valid as long as the image is.
template <typename Voxel>
std::span<const Voxel> voxels_of(const ItkImage<Voxel>& image) {
    return {image.GetBufferPointer(), image.GetLargestPossibleRegion().GetNumberOfPixels()};
}

/// The reason in an ITK exception, without class names and addresses, on one line.
std::string reason_of(const itk::ExceptionObject& error);

}  // namespace palpate::imaging
