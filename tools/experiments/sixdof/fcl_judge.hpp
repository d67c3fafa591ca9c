// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <memory>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::experiments {

/// FCL's answers about a tool and a surface, triangles against triangles: a judge that shares no code with
/// ours. A triangle mesh is a shell to FCL, so a tool deep within a bone, touching no triangle, does not
/// overlap it.
class FclJudge {
  public:
    FclJudge(const TriangleMesh& surface, const TriangleMesh& tool);
    ~FclJudge();

    /// The distance of the two with the tool at X_PT, mm; 0 where a triangle of one meets one of the other.
    double distance(const Eigen::Isometry3d& X_PT) const;
    /// Whether a triangle of one meets one of the other.
    bool meet(const Eigen::Isometry3d& X_PT) const;

  private:
    struct Models;
    std::unique_ptr<Models> models_;
};

}  // namespace palpate::experiments
