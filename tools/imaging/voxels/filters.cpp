// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/filters.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <itkCurvatureFlowImageFilter.h>
#include <itkMultiThreaderBase.h>

#include "tools/imaging/files/itk_image.hpp"
#include "tools/imaging/voxels/coarse_grid.hpp"

namespace palpate::imaging {
namespace {

constexpr std::size_t lines_together = 64;  // so that what is worked on stays in the cache

// Filters lines of `length` values that lie `stride` apart; up to lines_together neighbours at a time.
void gaussian_along(std::vector<float>& values, std::size_t length, std::size_t stride, double sigma) {
    if (length < 2) return;
    const std::size_t radius = std::min(length - 1, static_cast<std::size_t>(std::ceil(3 * sigma)));
    std::vector<float> weights;
    for (std::size_t r = 0; r <= radius; ++r)
        weights.push_back(static_cast<float>(std::exp(-0.5 * std::pow(static_cast<double>(r) / sigma, 2))));
    std::vector<float> totals(length, 0.0F);
    for (std::size_t at = 0; at < length; ++at)
        for (std::size_t other = at > radius ? at - radius : 0; other <= std::min(length - 1, at + radius);
             ++other)
            totals[at] += weights[other > at ? other - at : at - other];

    const std::size_t groups = (stride + lines_together - 1) / lines_together;
    const auto filter = [&](std::size_t n) {
        const std::size_t first = n % groups * lines_together,
                          lines = std::min(lines_together, stride - first);
        float* start = &values[n / groups * length * stride + first];
        std::vector<float> from(length * lines), sums(length * lines);
        for (std::size_t at = 0; at < length; ++at)
            std::copy_n(start + at * stride, lines, &from[at * lines]);
        for (std::size_t i = 0; i < from.size(); ++i) sums[i] = weights[0] * from[i];
        for (std::size_t r = 1; r <= radius; ++r) {
            const std::size_t shift = r * lines;
            for (std::size_t i = 0; i + shift < from.size(); ++i) sums[i] += weights[r] * from[i + shift];
            for (std::size_t i = shift; i < from.size(); ++i) sums[i] += weights[r] * from[i - shift];
        }
        for (std::size_t at = 0; at < length; ++at)
            for (std::size_t i = 0; i < lines; ++i)
                start[at * stride + i] = sums[at * lines + i] / totals[at];
    };
    itk::MultiThreaderBase::New()->ParallelizeArray(
        0, values.size() / length / stride * groups, [&](itk::SizeValueType n) { filter(n); }, nullptr);
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

Volume gradient_length(const Volume& volume, double sigma) {
    Volume smooth = volume, result = volume;
    gaussian(smooth.grid, smooth.values, sigma);
    const ImageGrid& grid = volume.grid;
    for_each_voxel(grid, [&](std::int32_t i, std::int32_t j, std::int32_t k, std::size_t offset) {
        double squared = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            std::array<std::int32_t, 3> low{i, j, k}, high{i, j, k};
            low[axis] = std::max(0, low[axis] - 1);
            high[axis] = std::min(grid.size[axis] - 1, high[axis] + 1);
            const double length =
                std::max(1, high[axis] - low[axis]) * grid.spacing[static_cast<Eigen::Index>(axis)];
            squared += std::pow((smooth.values[grid.offset(high[0], high[1], high[2])] -
                                 smooth.values[grid.offset(low[0], low[1], low[2])]) /
                                    length,
                                2);
        }
        result.values[offset] = static_cast<float>(std::sqrt(squared));
    });
    return result;
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

}  // namespace palpate::imaging
