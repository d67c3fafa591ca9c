// SPDX-License-Identifier: GPL-3.0-or-later
// The one file that FCL's headers are compiled in.
#include "tools/experiments/sixdof/fcl_judge.hpp"

#include <fcl/fcl.h>

namespace palpate::experiments {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<Model> model_of(const TriangleMesh& mesh) {
    std::vector<fcl::Triangle> triangles;
    for (const Triangle& t : mesh.triangles)
        triangles.emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                               static_cast<std::size_t>(t[2]));
    auto model = std::make_shared<Model>();
    model->beginModel();
    model->addSubModel(mesh.vertices, triangles);
    model->endModel();
    return model;
}

}  // namespace

struct FclJudge::Models {
    std::shared_ptr<Model> surface, tool;
};

FclJudge::FclJudge(const TriangleMesh& surface, const TriangleMesh& tool)
    : models_(std::make_unique<Models>(Models{model_of(surface), model_of(tool)})) {}

FclJudge::~FclJudge() = default;

bool FclJudge::meet(const Eigen::Isometry3d& X_PT) const {
    fcl::CollisionResultd met;
    return fcl::collide(models_->surface.get(), fcl::Transform3d::Identity(), models_->tool.get(), X_PT,
                        fcl::CollisionRequestd(), met) > 0;
}

double FclJudge::distance(const Eigen::Isometry3d& X_PT) const {
    if (meet(X_PT)) return 0;
    fcl::DistanceResultd result;
    return fcl::distance(models_->surface.get(), fcl::Transform3d::Identity(), models_->tool.get(), X_PT,
                         fcl::DistanceRequestd(), result);
}

}  // namespace palpate::experiments
