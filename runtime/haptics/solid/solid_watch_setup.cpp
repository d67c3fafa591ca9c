// SPDX-License-Identifier: Apache-2.0
// What a watch over a tool's surface allocates.
#include <algorithm>
#include <numeric>
#include <utility>

#include "runtime/haptics/solid/solid_watch.hpp"

namespace palpate::haptics {
namespace {

constexpr std::size_t most_slots = 4096;    // about one patch
constexpr std::size_t most_touches = 2048;  // of a pose
constexpr std::size_t most_planes = 8192;

}  // namespace

SolidWatch::SolidWatch(const collision::SurfaceFeatures& tool, std::span<const SolidBody> bodies)
    : tool_(tool),
      bodies_(bodies),
      triangles_(tool.triangle_count()),
      slots_(most_slots),
      touches_(most_touches),
      planes_(most_planes) {
    std::iota(triangles_.begin(), triangles_.end(), 0);
    part_in_patches(triangles_);
    for (const std::int32_t& triangle : triangles_) balls_.push_back(ball_about({&triangle, 1}));
    for (Patch& patch : patches_) longest_arm_ = std::max(longest_arm_, patch.arm);
    kept_.resize(patches_.size() * most_kept);
    wakes_.resize(kept_.size());
    near_.resize(patches_.size());
}

SolidWatch::Ball SolidWatch::ball_about(std::span<const std::int32_t> triangles) const {
    Eigen::AlignedBox3d box;
    for (const std::int32_t t : triangles)
        for (const Eigen::Vector3d& corner : tool_.corners(static_cast<std::size_t>(t))) box.extend(corner);
    Ball ball{box.center(), 0};
    for (const std::int32_t t : triangles)
        for (const Eigen::Vector3d& corner : tool_.corners(static_cast<std::size_t>(t)))
            ball.radius = std::max(ball.radius, (corner - ball.centre).norm());
    return ball;
}

// Halves them along the longest side of the box about their centres until few are left.
void SolidWatch::part_in_patches(std::span<std::int32_t> triangles) {
    if (triangles.size() > most_in_patch) {
        const auto centre_of = [&](std::int32_t t) -> Eigen::Vector3d {
            const collision::TriangleCorners corners = tool_.corners(static_cast<std::size_t>(t));
            return (corners[0] + corners[1] + corners[2]) / 3;
        };
        Eigen::AlignedBox3d box;
        for (const std::int32_t t : triangles) box.extend(centre_of(t));
        Eigen::Index axis = 0;
        box.sizes().maxCoeff(&axis);
        const std::size_t half = triangles.size() / 2;
        std::ranges::nth_element(triangles, triangles.begin() + static_cast<std::ptrdiff_t>(half), {},
                                 [&](std::int32_t t) { return std::pair(centre_of(t)[axis], t); });
        part_in_patches(triangles.first(half));
        part_in_patches(triangles.subspan(half));
        return;
    }
    Patch patch{.ball = ball_about(triangles),
                .arm = 0,
                .first = static_cast<std::int32_t>(triangles.data() - triangles_.data()),
                .count = static_cast<std::int32_t>(triangles.size())};
    for (const std::int32_t t : triangles)
        for (const Eigen::Vector3d& corner : tool_.corners(static_cast<std::size_t>(t)))
            patch.arm = std::max(patch.arm, corner.norm());
    patches_.push_back(patch);
}

}  // namespace palpate::haptics
