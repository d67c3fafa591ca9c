// SPDX-License-Identifier: GPL-3.0-or-later
// The one file that Bullet's headers are compiled in. Bodies are GImpact shapes, whose triangles are tested
// against each other; as a plain surface against it Bullet tells less of a depth.
#include "tools/experiments/sixdof/bullet_judge.hpp"

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <algorithm>
#include <btBulletCollisionCommon.h>
#include <vector>

namespace palpate::experiments {
namespace {

struct Body {
    std::vector<int> corners;
    std::vector<btScalar> vertices;  // mm
    std::unique_ptr<btTriangleIndexVertexArray> mesh;
    std::unique_ptr<btGImpactMeshShape> shape;
    btCollisionObject object;

    explicit Body(const TriangleMesh& surface) {
        for (const Triangle& t : surface.triangles) corners.insert(corners.end(), t.begin(), t.end());
        for (const Eigen::Vector3d& v : surface.vertices) vertices.insert(vertices.end(), v.begin(), v.end());
        mesh = std::make_unique<btTriangleIndexVertexArray>(
            static_cast<int>(surface.triangles.size()), corners.data(), static_cast<int>(3 * sizeof(int)),
            static_cast<int>(surface.vertices.size()), vertices.data(),
            static_cast<int>(3 * sizeof(btScalar)));
        shape = std::make_unique<btGImpactMeshShape>(mesh.get());
        shape->setMargin(0);
        shape->updateBound();
        object.setCollisionShape(shape.get());
    }

    btCollisionObjectWrapper wrapped() const {
        return {nullptr, object.getCollisionShape(), &object, object.getWorldTransform(), -1, -1};
    }
};

// Keeps of all contacts the deepest.
struct Deepest final : btManifoldResult {
    double depth = 0;
    using btManifoldResult::btManifoldResult;
    void addContactPoint(const btVector3&, const btVector3&, btScalar distance) override {
        depth = std::max(depth, -static_cast<double>(distance));
    }
};

}  // namespace

struct BulletJudge::Models {
    Body surface, tool;
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
};

BulletJudge::BulletJudge(const TriangleMesh& surface, const TriangleMesh& tool)
    : models_(new Models{Body(surface), Body(tool), {}}) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&models_->dispatcher);
}

BulletJudge::~BulletJudge() = default;

double BulletJudge::depth(const Eigen::Isometry3d& X_PT) const {
    const Eigen::Quaterniond q(X_PT.linear());
    const Eigen::Vector3d& p = X_PT.translation();
    models_->tool.object.setWorldTransform(
        btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), btVector3(p.x(), p.y(), p.z())));
    const btCollisionObjectWrapper surface = models_->surface.wrapped(), tool = models_->tool.wrapped();
    btCollisionAlgorithm* algorithm =
        models_->dispatcher.findAlgorithm(&surface, &tool, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    Deepest deepest(&surface, &tool);
    algorithm->processCollision(&surface, &tool, btDispatcherInfo(), &deepest);
    algorithm->~btCollisionAlgorithm();
    models_->dispatcher.freeCollisionAlgorithm(algorithm);
    return deepest.depth;
}

}  // namespace palpate::experiments
