// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/necks.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace palpate::imaging {
namespace {

// Bodies that meet, as a forest; a body's radius is the largest depth in it.
class Bodies {
  public:
    std::uint32_t add(float radius) {
        parent_.push_back(static_cast<std::uint32_t>(parent_.size()));
        radius_.push_back(radius);
        return parent_.back();
    }

    std::uint32_t root(std::uint32_t body) {
        while (parent_[body] != body) body = parent_[body] = parent_[parent_[body]];
        return body;
    }

    float radius(std::uint32_t root) const { return radius_[root]; }

    // The body that both become; the first found has the larger radius, as depths fall.
    std::uint32_t join(std::uint32_t a, std::uint32_t b) {
        const auto [low, high] = std::minmax(a, b);
        return parent_[high] = low;
    }

  private:
    std::vector<std::uint32_t> parent_;
    std::vector<float> radius_;
};

}  // namespace

Mask cut_at_necks(const Mask& mask, std::span<const float> depth, std::span<const std::size_t> inside,
                  double neck_ratio) {
    constexpr std::uint32_t none = UINT32_MAX;
    std::vector<std::uint32_t> order;
    for (std::size_t i = 0; i < mask.voxels.size(); ++i)
        if (mask.voxels[i]) order.push_back(static_cast<std::uint32_t>(i));
    std::ranges::stable_sort(order, [&](std::uint32_t a, std::uint32_t b) { return depth[a] > depth[b]; });

    const auto& size = mask.grid.size;
    const auto row = static_cast<std::size_t>(size[0]), slice = row * static_cast<std::size_t>(size[1]);
    const std::array<std::size_t, 3> stride{1, row, slice};
    std::vector<std::uint32_t> body_of(mask.voxels.size(), none);
    Bodies bodies;
    for (const std::uint32_t voxel : order) {
        const std::array<std::size_t, 3> index{voxel % row, voxel % slice / row, voxel / slice};
        std::array<std::uint32_t, 6> met{};
        std::size_t count = 0;
        const auto meet = [&](std::size_t neighbour) {
            if (body_of[neighbour] != none) met[count++] = bodies.root(body_of[neighbour]);
        };
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (index[axis] > 0) meet(voxel - stride[axis]);
            if (index[axis] + 1 < static_cast<std::size_t>(size[axis])) meet(voxel + stride[axis]);
        }
        if (count == 0) {
            body_of[voxel] = bodies.add(depth[voxel]);
            continue;
        }
        std::uint32_t body = none;  // the one with the largest radius
        for (std::size_t n = 0; n < count; ++n) body = std::min(body, met[n]);
        for (std::size_t n = 0; n < count; ++n) {
            const std::uint32_t other = bodies.root(met[n]);
            if (other != body &&
                depth[voxel] >= neck_ratio * std::min(bodies.radius(body), bodies.radius(other)))
                body = bodies.join(body, other);
        }
        body_of[voxel] = body;
    }

    std::vector<std::uint32_t> kept;
    for (const std::size_t voxel : inside) kept.push_back(bodies.root(body_of[voxel]));
    Mask result{mask.grid, std::vector<std::uint8_t>(mask.voxels.size(), 0)};
    for (const std::uint32_t voxel : order)
        result.voxels[voxel] = std::ranges::find(kept, bodies.root(body_of[voxel])) != kept.end();
    return result;
}

}  // namespace palpate::imaging
