// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/features/feature_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/collision/balls/ball_pairs.hpp"
#include "runtime/collision/convex/equally_near_vertices.hpp"

namespace palpate::haptics {

using collision::PieceNode;
using collision::TrianglePair;
using collision::TrianglePoint;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

// mm, rad; a choice: with more, pairs are gathered less often and there are more of them.
constexpr Motion most_slack{.way = 0.4, .turn = 0.01};
constexpr int halvings = 4;  // of the slack, where pairs find no room

}  // namespace

void FeatureWatch::reset() noexcept {
    valid_ = met_ = false;
    travel_ = {};
    gaps_.forget();
}

void FeatureWatch::look(const ToolPose& pose) noexcept {
    if (valid_) travel_ += motion_between(pose_, pose);
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
    const Motion motion = motion_between(gathered_at_, pose_);
    return valid_ && motion.way <= slack_.way && motion.turn <= slack_.turn;
}

// With as much slack as pairs find room.
void FeatureWatch::gather(const Isometry3d& X_PT) noexcept {
    std::swap(now_, before_);
    if (!valid_) before_.clear();
    gathered_at_ = pose_;
    valid_ = keeps_ = true;
    slack_ = most_slack;
    for (int halving = 0; halving <= halvings; ++halving) {
        if (gather(X_PT, slack_)) return;
        slack_ = {slack_.way / 2, slack_.turn / 2};
    }
    now_.clear();
    keeps_ = false;
    slack_ = most_slack;
}

bool FeatureWatch::gather(const Isometry3d& X_PT, const Motion& slack) noexcept {
    now_.clear();
    for (std::size_t body = 0; body < bodies_.size(); ++body)
        if (!collision::for_each_pair(
                tool_, bodies_[body],
                [&](const PieceNode& a, const PieceNode& b) {
                    return collision::may_be_near(a, X_PT, b,
                                                  gaps_.within() + slack.of(static_cast<double>(a.arm)));
                },
                [&](const PieceNode& mine, const PieceNode& its) {
                    return keep(static_cast<std::int32_t>(body), mine, its,
                                collision::least_apart(mine, X_PT, its));
                }))
            return false;
    return true;
}

// The pair of pieces of two triangles whose balls are so far apart; false if there is no room. What was known
// of the pair before is known still.
bool FeatureWatch::keep(std::int32_t body, const PieceNode& mine, const PieceNode& its,
                        double apart) noexcept {
    const auto arm = static_cast<double>(tool_.node(tool_.piece(mine.piece).root).arm);
    const double due = travel_.of(arm) + apart - gaps_.within() - travel_rounding;
    const Kept fresh{{mine.piece, its.piece, {mine.triangle}, {its.triangle}}, body, arm, due, false};
    std::int32_t& at = now_.index.at(body, mine.piece, its.piece);
    if (at != PairIndex::none) {
        Kept& kept = now_.kept[static_cast<std::size_t>(at)];
        if (!kept.was_followed && due < kept.due) kept = fresh;
        return true;
    }
    if (now_.count == now_.kept.size()) return false;
    at = static_cast<std::int32_t>(now_.count++);
    const std::int32_t was_at = before_.index.find(body, mine.piece, its.piece);
    const bool was_followed =
        was_at != PairIndex::none && before_.kept[static_cast<std::size_t>(was_at)].was_followed;
    now_.kept[static_cast<std::size_t>(at)] =
        was_followed ? before_.kept[static_cast<std::size_t>(was_at)] : fresh;
    return true;
}

void FeatureWatch::follow(const Isometry3d& X_PT) noexcept {
    const double within = gaps_.within();
    for (Kept& kept : now_.all()) {
        const double travel = travel_.of(kept.arm);
        if (kept.due > travel) continue;
        const collision::ConvexPieces& body = bodies_[static_cast<std::size_t>(kept.body)];
        const auto [nearest, at_least] =
            collision::closest_features(tool_, X_PT, body, within, kept.features);
        kept.was_followed = true;
        kept.due = travel + at_least - within - travel_rounding;
        if (at_least > within ||
            !consider(kept.body, {kept.features.on_a.triangle, kept.features.on_b.triangle, nearest}, X_PT))
            continue;
        const std::size_t others =
            collision::equally_near_vertices(tool_, X_PT, body, kept.features, nearest, beside_);
        for (const collision::NearTriangles& near : std::span(beside_).first(others))
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
bool FeatureWatch::consider(std::int32_t body, const collision::NearTriangles& near,
                            const Isometry3d& X_PT) noexcept {
    const TrianglePoint &on_tool = near.points.on_a, &on_body = near.points.on_b;
    const double distance = std::sqrt(on_tool.squared_distance);
    gaps_.saw(distance);
    if (!(distance > 0)) {
        met_ = true;
        return false;
    }
    const Vector3d way = on_tool.point - on_body.point;
    if (!bodies_[static_cast<std::size_t>(body)].features().is_nearest_outside(
            static_cast<std::size_t>(near.triangle_b), on_body, way))
        return false;
    TrianglePoint in_tool = on_tool;
    in_tool.point = X_PT.inverse() * on_tool.point;
    if (!tool_.features().is_nearest_outside(static_cast<std::size_t>(near.triangle_a), in_tool,
                                             -(X_PT.linear().transpose() * way)))
        return false;
    const Gap gap{near.triangle_a, body, on_tool.point, on_body.point, distance};
    if (found_count_ < found_.size()) {
        found_[found_count_++] = gap;
        return true;
    }
    Gap& widest = *std::ranges::max_element(found_, {}, &Gap::distance);
    if (gap.distance < widest.distance) widest = gap;
    return true;
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
