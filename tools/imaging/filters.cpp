// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/filters.hpp"

#include <algorithm>
#include <cmath>
#include <itkCurvatureFlowImageFilter.h>
#include <itkMultiThreaderBase.h>

#include "tools/imaging/itk_image.hpp"

namespace palpate {
namespace {

// Filters every line along one axis; lines that neighbour in memory are taken together.
void gaussian_along(std::vector<float>& values, std::size_t length, std::size_t stride, double sigma) {
    if (length < 2) return;
    const auto radius = static_cast<std::size_t>(std::ceil(3 * sigma));
    std::vector<float> weights;
    for (std::size_t r = 0; r <= radius; ++r)
        weights.push_back(static_cast<float>(std::exp(-0.5 * std::pow(static_cast<double>(r) / sigma, 2))));
    const std::size_t plane = length * stride;
    const auto filter = [&](std::size_t n) {
        std::vector<float> sums(plane, 0.0F);
        const float* from = &values[n * plane];
        for (std::size_t at = 0; at < length; ++at) {
            const std::size_t first = at > radius ? at - radius : 0, last = std::min(length - 1, at + radius);
            float total = 0;
            for (std::size_t other = first; other <= last; ++other)
                total += weights[other > at ? other - at : at - other];
            float* to = &sums[at * stride];
            for (std::size_t other = first; other <= last; ++other) {
                const float weight = weights[other > at ? other - at : at - other] / total;
                const float* line = from + other * stride;
                for (std::size_t i = 0; i < stride; ++i) to[i] += weight * line[i];
            }
        }
        std::ranges::copy(sums, values.begin() + static_cast<std::ptrdiff_t>(n * plane));
    };
    itk::MultiThreaderBase::New()->ParallelizeArray(
        0, values.size() / plane, [&](itk::SizeValueType n) { filter(n); }, nullptr);
}

}  // namespace

void gaussian(const ImageGrid& grid, std::vector<float>& values, double sigma) {
    if (sigma <= 0) return;
    std::size_t stride = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto length = static_cast<std::size_t>(grid.size[axis]);
        gaussian_along(values, length, stride, sigma / grid.spacing[static_cast<Eigen::Index>(axis)]);
        stride *= length;
    }
}

Volume curvature_flow(const Volume& volume, int iterations) {
    auto filter = itk::CurvatureFlowImageFilter<ItkImage<float>, ItkImage<float>>::New();
    filter->SetInput(to_itk<float>(volume.grid, volume.values));
    filter->SetNumberOfIterations(static_cast<unsigned>(iterations));
    filter->SetTimeStep(0.125);  // in voxels: the largest that is stable in three dimensions
    filter->SetUseImageSpacing(false);
    filter->Update();
    const auto values = voxels_of(*filter->GetOutput());
    return {volume.grid, {values.begin(), values.end()}};
}

}  // namespace palpate
