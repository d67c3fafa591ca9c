// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/mask.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <itkBinaryFillholeImageFilter.h>
#include <itkConnectedComponentImageFilter.h>
#include <itkRelabelComponentImageFilter.h>
#include <itkSignedMaurerDistanceMapImageFilter.h>
#include <limits>
#include <numeric>

#include "tools/imaging/files/itk_image.hpp"
#include "tools/imaging/voxels/filters.hpp"

namespace palpate::imaging {
namespace {

using MaskImage = ItkImage<std::uint8_t>;

MaskImage::Pointer image_of(const Mask& mask) {
    return to_itk<std::uint8_t>(mask.grid, mask.voxels);
}

Mask complement(Mask mask) {
    for (std::uint8_t& voxel : mask.voxels) voxel = !voxel;
    return mask;
}

Mask combine(const Mask& a, const Mask& b, bool b_inside) {
    Mask result = a;
    for (std::size_t i = 0; i < result.voxels.size(); ++i)
        result.voxels[i] = a.voxels[i] && (b.voxels[i] != 0) == b_inside;
    return result;
}

}  // namespace

std::size_t Mask::count() const {
    return std::accumulate(voxels.begin(), voxels.end(), std::size_t{0});
}

bool Region::contains(const Eigen::Vector3d& p_P) const {
    if (sphere && (p_P - sphere->center).squaredNorm() > sphere->radius * sphere->radius) return false;
    return !box || ((p_P.array() >= box->low.array()).all() && (p_P.array() <= box->high.array()).all());
}

Components components_of(const Mask& mask) {
    using LabelImage = ItkImage<std::uint32_t>;
    auto connect = itk::ConnectedComponentImageFilter<MaskImage, LabelImage>::New();
    connect->SetInput(image_of(mask));
    auto relabel = itk::RelabelComponentImageFilter<LabelImage, LabelImage>::New();
    relabel->SetInput(connect->GetOutput());
    relabel->Update();
    const auto labels = voxels_of(*relabel->GetOutput());
    Components pieces;
    pieces.labels.assign(labels.begin(), labels.end());
    for (const auto size : relabel->GetSizeOfObjectsInPixels())
        pieces.sizes.push_back(static_cast<std::size_t>(size));
    return pieces;
}

Mask select(const Mask& mask, const Components& pieces, const std::function<bool(std::uint32_t)>& keep) {
    std::vector<std::uint8_t> kept(pieces.sizes.size() + 1, 0);
    for (std::uint32_t n = 1; n < kept.size(); ++n) kept[n] = keep(n);
    Mask result{mask.grid, std::vector<std::uint8_t>(mask.voxels.size())};
    std::ranges::transform(pieces.labels, result.voxels.begin(), [&](std::uint32_t n) { return kept[n]; });
    return result;
}

Mask keep_largest(const Mask& mask) {
    return select(mask, components_of(mask), [](std::uint32_t n) { return n == 1; });
}

Mask drop_small(const Mask& mask, double volume) {
    const Components pieces = components_of(mask);
    return select(mask, pieces, [&](std::uint32_t n) {
        return static_cast<double>(pieces.sizes[n - 1]) * mask.grid.voxel_volume() >= volume;
    });
}

std::vector<float> distance_to(const Mask& mask) {
    if (mask.count() == 0)
        return std::vector<float>(mask.voxels.size(), std::numeric_limits<float>::infinity());
    auto filter = itk::SignedMaurerDistanceMapImageFilter<MaskImage, ItkImage<float>>::New();
    filter->SetInput(image_of(mask));
    filter->SetUseImageSpacing(true);
    filter->SetSquaredDistance(false);
    filter->Update();
    const auto signed_distances = voxels_of(*filter->GetOutput());
    std::vector<float> distances(signed_distances.size());
    std::ranges::transform(signed_distances, distances.begin(), [](float d) { return std::max(d, 0.0F); });
    return distances;
}

std::vector<float> depth_in(const Mask& mask) {
    return distance_to(complement(mask));
}

Mask mask_of(const LabelMap& map, std::int32_t value) {
    Mask mask{map.grid, std::vector<std::uint8_t>(map.labels.size())};
    std::ranges::transform(map.labels, mask.voxels.begin(),
                           [&](std::uint16_t label) -> std::uint8_t { return label == value; });
    return mask;
}

Mask labelled(const LabelMap& map) {
    Mask mask{map.grid, std::vector<std::uint8_t>(map.labels.size())};
    std::ranges::transform(map.labels, mask.voxels.begin(),
                           [](std::uint16_t label) -> std::uint8_t { return label != 0; });
    return mask;
}

IndexBox voxels_around(const ImageGrid& grid, const Eigen::Vector3d& p_P, double reach) {
    const Eigen::Array3d center = grid.index_of(p_P), step = reach * grid.spacing.cwiseInverse(),
                         size = Eigen::Array3i::Map(grid.size.data()).cast<double>();
    return {(center - step).ceil().max(0).min(size).cast<int>(),
            (center + step).floor().max(-1).min(size - 1).cast<int>()};
}

std::optional<std::size_t> nearest_voxel(const Mask& mask, const Eigen::Vector3d& p_P, double reach) {
    const ImageGrid& grid = mask.grid;
    const auto [low, high] = voxels_around(grid, p_P, reach);
    std::optional<std::size_t> found;
    double nearest = reach * reach;
    for (int k = low[2]; k <= high[2]; ++k)
        for (int j = low[1]; j <= high[1]; ++j)
            for (int i = low[0]; i <= high[0]; ++i) {
                if (!mask.voxels[grid.offset(i, j, k)]) continue;
                const double squared = (grid.point_of(Eigen::Vector3d(i, j, k)) - p_P).squaredNorm();
                if (squared > nearest || (found && squared == nearest)) continue;
                nearest = squared;
                found = grid.offset(i, j, k);
            }
    return found;
}

Mask dilate(const Mask& mask, double radius) {
    if (radius <= 0) return mask;
    const std::vector<float> distances = distance_to(mask);
    // Voxel centres exactly one radius away belong to the ball; float32 must not decide otherwise.
    const float reach = static_cast<float>(radius * (1 + 1e-5));
    Mask result = mask;
    std::ranges::transform(distances, result.voxels.begin(),
                           [&](float d) -> std::uint8_t { return d <= reach; });
    return result;
}

Mask erode(const Mask& mask, double radius) {
    return complement(dilate(complement(mask), radius));
}

Mask open(const Mask& mask, double radius) {
    return dilate(erode(mask, radius), radius);
}

Mask close(const Mask& mask, double radius) {
    return erode(dilate(mask, radius), radius);
}

Mask fill_holes(const Mask& mask) {
    auto filter = itk::BinaryFillholeImageFilter<MaskImage>::New();
    filter->SetInput(image_of(mask));
    filter->SetForegroundValue(1);
    filter->Update();
    const auto filled = voxels_of(*filter->GetOutput());
    return {mask.grid, {filled.begin(), filled.end()}};
}

Mask smooth(const Mask& mask, double size) {
    const std::size_t inside = mask.count();
    if (size <= 0 || inside == 0) return mask;
    std::vector<float> share(mask.voxels.begin(), mask.voxels.end());
    gaussian(mask.grid, share, size / 2);
    std::vector<float> sorted = share;
    const auto last_inside = sorted.begin() + static_cast<std::ptrdiff_t>(inside - 1);
    std::ranges::nth_element(sorted, last_inside, std::greater<>());
    Mask result = mask;
    std::ranges::transform(share, result.voxels.begin(),
                           [&](float value) -> std::uint8_t { return value >= *last_inside; });
    return result;
}

Mask intersect(const Mask& a, const Mask& b) {
    return combine(a, b, true);
}

Mask subtract(const Mask& a, const Mask& b) {
    return combine(a, b, false);
}

Mask clip(const Mask& mask, const Region& region) {
    if (!region.sphere && !region.box) return mask;
    Mask result = mask;
    const auto& size = mask.grid.size;
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < size[2]; ++k)
        for (std::int32_t j = 0; j < size[1]; ++j)
            for (std::int32_t i = 0; i < size[0]; ++i, ++offset)
                if (result.voxels[offset] && !region.contains(mask.grid.point_of(Eigen::Vector3d(i, j, k))))
                    result.voxels[offset] = 0;
    return result;
}

}  // namespace palpate::imaging
