// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/features/feature_watch.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/collision/balls/ball_pairs.hpp"
#include "runtime/collision/convex/near_vertices.hpp"

namespace palpate::haptics {

using collision::PieceNode;
using collision::TrianglePair;
using collision::TrianglePoint;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

constexpr double most_slack = 1, least_slack = 0.03;  // mm
constexpr double travel_rounding = 1e-9;              // mm

// Whether a point of a triangle is its surface's locally nearest in a direction, both in the surface's frame.
bool is_locally_nearest(const collision::SurfaceFeatures& surface, std::int32_t triangle,
                        const TrianglePoint& found, const Vector3d& direction) noexcept {
    const auto t = static_cast<std::size_t>(triangle);
    if (found.feature == collision::Feature::face)
        return collision::unit_normal(surface.corners(t)).dot(direction) > 0;
    return surface.is_nearest(t, found, direction);
}

}  // namespace

void FeatureWatch::Index::clear() noexcept {
    std::ranges::fill(slots_, Slot{});
}

bool FeatureWatch::Index::add(std::int32_t body, std::int32_t mine, std::int32_t its) noexcept {
    const auto mixed = (static_cast<std::uint64_t>(mine) * 0x9E3779B97F4A7C15U) ^
                       (static_cast<std::uint64_t>(its) * 0xC2B2AE3D27D4EB4FU) ^
                       static_cast<std::uint64_t>(body);
    for (std::size_t at = (mixed ^ mixed >> 32U) & (slots_.size() - 1);;
         at = (at + 1) & (slots_.size() - 1)) {
        Slot& slot = slots_[at];
        if (slot.body < 0) {
            slot = {body, mine, its};
            return true;
        }
        if (slot.body == body && slot.mine == mine && slot.its == its) return false;
    }
}

void FeatureWatch::reset() noexcept {
    valid_ = met_ = false;
    gaps_.forget();
}

void FeatureWatch::look(const ToolPose& pose) noexcept {
    if (valid_) travel_ += reach_between(pose_, pose);
    pose_ = pose;
    const Isometry3d X_PT = placement_of(pose);
    if (!holds()) gather(X_PT);
    gaps_.begin(pose.position);
    found_count_ = 0;
    met_ = false;
    if (keeps_)
        follow(X_PT);
    else
        search(X_PT);
    cluster();
}

bool FeatureWatch::holds() const noexcept {
    return valid_ && reach_between(gathered_at_, pose_) <= slack_;
}

// With as much slack as pairs find room.
void FeatureWatch::gather(const Isometry3d& X_PT) noexcept {
    gathered_at_ = pose_;
    valid_ = true;
    keeps_ = true;
    for (slack_ = most_slack; slack_ >= least_slack; slack_ /= 2)
        if (gather(X_PT, slack_)) return;
    keeps_ = false;
    slack_ = most_slack;
}

bool FeatureWatch::gather(const Isometry3d& X_PT, double slack) noexcept {
    kept_count_ = 0;
    index_.clear();
    const double within = gaps_.within() + slack;
    for (std::size_t body = 0; body < bodies_.size(); ++body)
        if (!collision::for_each_pair(
                tool_, bodies_[body],
                [&](const PieceNode& a, const PieceNode& b) {
                    return collision::may_be_near(a, X_PT, b, within);
                },
                [&](const PieceNode& mine, const PieceNode& its) {
                    if (!index_.add(static_cast<std::int32_t>(body), mine.piece, its.piece)) return true;
                    if (kept_count_ == kept_.size()) return false;
                    kept_[kept_count_++] = {{mine.piece, its.piece, mine.triangle, its.triangle},
                                            static_cast<std::int32_t>(body),
                                            travel_};
                    return true;
                }))
            return false;
    return true;
}

void FeatureWatch::follow(const Isometry3d& X_PT) noexcept {
    const double within = gaps_.within();
    for (Kept& kept : std::span(kept_).first(kept_count_)) {
        if (kept.due > travel_) continue;
        const collision::ConvexPieces& body = bodies_[static_cast<std::size_t>(kept.body)];
        const TrianglePair nearest =
            collision::closest_features(tool_, X_PT, body, within + slack_, kept.features);
        const double distance = std::min(std::sqrt(nearest.on_a.squared_distance), within + slack_);
        kept.due = travel_ + distance - within - travel_rounding;
        if (distance > within) continue;
        consider(kept.body, {kept.features.triangle_a, kept.features.triangle_b, nearest}, X_PT);
        const std::size_t beside =
            met_ ? 0 : collision::near_vertices(tool_, X_PT, body, kept.features, nearest, within, beside_);
        for (const collision::NearTriangles& near : std::span(beside_).first(beside))
            consider(kept.body, near, X_PT);
    }
}

void FeatureWatch::search(const Isometry3d& X_PT) noexcept {
    for (std::size_t body = 0; body < bodies_.size(); ++body)
        collision::for_each_pair(
            tool_, bodies_[body],
            [&](const PieceNode& a, const PieceNode& b) {
                return collision::may_be_near(a, X_PT, b, gaps_.within());
            },
            [&](const PieceNode& mine, const PieceNode& its) {
                const TrianglePair pair = collision::closest_points_of_triangles(
                    collision::placed(X_PT,
                                      tool_.features().corners(static_cast<std::size_t>(mine.triangle))),
                    bodies_[body].features().corners(static_cast<std::size_t>(its.triangle)));
                if (pair.on_a.squared_distance <= gaps_.within() * gaps_.within())
                    consider(static_cast<std::int32_t>(body), {mine.triangle, its.triangle, pair}, X_PT);
                return true;
            });
}

// A place counts where the surfaces beside it are no nearer: else it is a neighbouring piece's.
void FeatureWatch::consider(std::int32_t body, const collision::NearTriangles& near,
                            const Isometry3d& X_PT) noexcept {
    const TrianglePoint &on_tool = near.points.on_a, &on_body = near.points.on_b;
    const double distance = std::sqrt(on_tool.squared_distance);
    gaps_.saw(distance);
    if (!(distance > 0)) {
        met_ = true;
        return;
    }
    const Vector3d way = on_tool.point - on_body.point;
    if (!is_locally_nearest(bodies_[static_cast<std::size_t>(body)].features(), near.triangle_b, on_body,
                            way))
        return;
    TrianglePoint in_tool = on_tool;
    in_tool.point = X_PT.inverse() * on_tool.point;
    if (!is_locally_nearest(tool_.features(), near.triangle_a, in_tool, -(X_PT.linear().transpose() * way)))
        return;
    const Gap gap{near.triangle_a, body, on_tool.point, on_body.point, distance};
    if (found_count_ < found_.size()) {
        found_[found_count_++] = gap;
        return;
    }
    Gap& widest = *std::ranges::max_element(found_, {}, &Gap::distance);
    if (gap.distance < widest.distance) widest = gap;
}

// Of places that are near each other and push the same way, the nearest stands for all.
void FeatureWatch::cluster() noexcept {
    const std::span<Gap> found = std::span(found_).first(found_count_);
    std::ranges::sort(found, {}, &Gap::distance);
    std::size_t clusters = 0;
    for (const Gap& gap : found) {
        const bool belongs = std::ranges::any_of(found.first(clusters), [&](const Gap& of) {
            return (gap.on_tool - of.on_tool).squaredNorm() <= cluster_radius * cluster_radius &&
                   gap.normal().dot(of.normal()) >= cluster_cosine;
        });
        if (belongs) continue;
        gaps_.add(gap);
        found[clusters++] = gap;
    }
}

bool FeatureWatch::meets(const ToolPose& pose) const noexcept {
    const Isometry3d X_PT = placement_of(pose);
    return std::ranges::any_of(bodies_, [&](const collision::ConvexPieces& body) {
        return collision::surfaces_meet(tool_, X_PT, body);
    });
}

}  // namespace palpate::haptics
