// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/labels/gaussian.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::meshing {
namespace {

std::vector<float> gaussian_weights(double sigma) {
    const auto reach = static_cast<int>(std::ceil(gaussian_reach * sigma));
    std::vector<double> weights;
    double sum = 0;
    for (int k = -reach; k <= reach; ++k) {
        weights.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
        sum += weights.back();
    }
    std::vector<float> normalised;
    for (const double weight : weights) normalised.push_back(static_cast<float>(weight / sum));
    return normalised;
}

// Adds weight x from[0 .. count) to to[0 .. count).
void add_scaled(float* to, const float* from, std::ptrdiff_t count, float weight) {
    for (std::ptrdiff_t i = 0; i < count; ++i) to[i] += weight * from[i];
}

// Rows of i stay whole, so the inner loop runs over neighbours in memory for all three axes.
void convolve(const std::vector<float>& from, std::vector<float>& to, const std::array<std::int32_t, 3>& size,
              std::size_t axis, const std::vector<float>& weights) {
    const std::ptrdiff_t nx = size[0], ny = size[1];
    const std::ptrdiff_t stride = axis == 0 ? 1 : axis == 1 ? nx : nx * ny;
    const auto reach = static_cast<std::ptrdiff_t>(weights.size() / 2);
    std::ranges::fill(to, 0.0F);
    for (std::ptrdiff_t k = 0; k < size[2]; ++k)
        for (std::ptrdiff_t j = 0; j < ny; ++j) {
            const std::ptrdiff_t row = (k * ny + j) * nx;
            const std::ptrdiff_t position = axis == 1 ? j : k;
            for (std::ptrdiff_t d = -reach; d <= reach; ++d) {
                std::ptrdiff_t begin = 0, end = nx;
                if (axis == 0) {
                    begin = std::max<std::ptrdiff_t>(0, -d);
                    end = std::min(nx, nx - d);
                } else if (position + d < 0 || position + d >= size[axis]) {
                    continue;
                }
                add_scaled(to.data() + row + begin, from.data() + row + begin + d * stride, end - begin,
                           weights[d + reach]);
            }
        }
}

}  // namespace

void smooth(FloatImage& image) {
    std::vector<float> other(image.values.size());
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(image.sigma_voxels[axis] > 0)) continue;
        convolve(image.values, other, image.size, axis, gaussian_weights(image.sigma_voxels[axis]));
        std::swap(image.values, other);
    }
}

}  // namespace palpate::meshing
