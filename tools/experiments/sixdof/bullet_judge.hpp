// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <memory>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::experiments {

/// Bullet's answer to how deep a tool is in a surface: a judge that shares no code with ours, nor with FCL.
/// Triangles that meet are as deep as one has to be moved along the other's normal; so what is deeper than
/// triangles are large is told as less. One thread.
class BulletJudge {
  public:
    BulletJudge(const TriangleMesh& surface, const TriangleMesh& tool);
    ~BulletJudge();

    /// The depth of the deepest of all pairs of triangles that meet with the tool at X_PT, mm; 0: none does.
    double depth(const Eigen::Isometry3d& X_PT) const;

  private:
    struct Models;
    std::unique_ptr<Models> models_;
};

}  // namespace palpate::experiments
