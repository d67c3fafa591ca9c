// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/sixdof/tool_judge.hpp"

#include <algorithm>
#include <cmath>

#include "formats/model/arrays.hpp"

namespace palpate::experiments {
namespace {

constexpr std::size_t judging_points = 20'000;
constexpr double clear_within = 2;    // mm, up to which distances are compared
constexpr double farthest_deep = 14;  // mm, up to which depths are told

}  // namespace

Eigen::Isometry3d pose_in(const TickResult& result) {
    Eigen::Isometry3d X_PT = Eigen::Isometry3d::Identity();
    X_PT.linear() = quaternion_of(result.tool_orientation).toRotationMatrix();
    X_PT.translation() = vector_of(result.tool_position);
    return X_PT;
}

ToolJudge::ToolJudge(const TriangleMesh& bone, const collision::CollisionSurface& surface,
                     const TriangleMesh& tool, std::span<const collision::ShellPoint> shell)
    : fcl_(bone, tool),
      bullet_(bone, tool),
      surface_(surface),
      others_(collision::point_shell(tool, judging_points).points),
      shell_(shell) {}

void ToolJudge::judge(const TickResult& result, Judged& judged) const {
    const Eigen::Isometry3d X_PT = pose_in(result);
    ++judged.poses;
    const double deep = -least_distance(others_, X_PT);
    judged.deepest = std::max(judged.deepest, deep);
    judged.by_bullet = std::max(judged.by_bullet, bullet_.depth(X_PT));
    const double apart = fcl_.distance(X_PT);
    judged.met += apart == 0;
    if (apart == 0 && result.contact_count == 0) {
        ++judged.unfelt;
        judged.unfelt_deepest = std::max(judged.unfelt_deepest, deep);
    }
    if (!shell_.empty() && apart > 0 && apart < clear_within)
        judged.apart = std::max(judged.apart, std::abs(least_distance(shell_, X_PT) - apart));
}

// Signed, of the points; 2 * clear_within for all that are farther.
double ToolJudge::least_distance(std::span<const collision::ShellPoint> points,
                                 const Eigen::Isometry3d& X_PT) const {
    double least = 2 * clear_within;
    std::int32_t hint = -1;
    for (const collision::ShellPoint& point : points) {
        const Eigen::Vector3d p = X_PT * point.position.cast<double>();
        const auto nearest = surface_.closest_point(p, farthest_deep, hint);
        if (!nearest) continue;
        hint = nearest->slot;
        const bool outside = surface_.is_outside(p, *nearest);
        least = std::min(least, outside ? nearest->distance : -nearest->distance);
    }
    return least;
}

}  // namespace palpate::experiments
