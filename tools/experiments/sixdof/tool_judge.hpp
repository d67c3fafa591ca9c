// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "formats/records/tick_result.hpp"
#include "runtime/collision/collision_surface.hpp"
#include "runtime/collision/points/point_shell.hpp"
#include "tools/experiments/sixdof/bullet_judge.hpp"
#include "tools/experiments/sixdof/fcl_judge.hpp"

namespace palpate::experiments {

/// Where a tick has its tool, X_PT.
Eigen::Isometry3d pose_in(const TickResult& result);

/// What judges found in all the poses that they were asked of.
struct Judged {
    std::size_t poses = 0, met = 0, unfelt = 0;  ///< that meet the bone by FCL; of these, without force
    double deepest = 0;                          ///< of other points of the tool, exact, mm
    double by_bullet = 0;                        ///< of triangles, mm
    double unfelt_deepest = 0;                   ///< of points, where nothing was felt, mm
    double apart = 0;  ///< most between FCL's distance and the shell's points', where both are clear, mm
};

/// Judges poses of a tool on a bone: by points of its surface that no scheme has, with exact distances, by
/// FCL and by Bullet.
class ToolJudge {
  public:
    /// `surface`: of the bone. `shell`: points whose distance is compared with FCL's; may be none. All but
    /// the tool must outlive this.
    ToolJudge(const TriangleMesh& bone, const collision::CollisionSurface& surface, const TriangleMesh& tool,
              std::span<const collision::ShellPoint> shell);

    void judge(const TickResult& result, Judged& judged) const;

  private:
    double least_distance(std::span<const collision::ShellPoint> points, const Eigen::Isometry3d& X_PT) const;

    FclJudge fcl_;
    BulletJudge bullet_;
    const collision::CollisionSurface& surface_;
    std::vector<collision::ShellPoint> others_;
    std::span<const collision::ShellPoint> shell_;
};

}  // namespace palpate::experiments
