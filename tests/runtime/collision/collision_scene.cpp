// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/collision/collision_scene.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "tests/formats/sample_case.hpp"

namespace palpate {

using namespace collision;
using Eigen::Vector3d;

Vector3d in_cube(double half_edge, std::mt19937& generator) {
    std::uniform_real_distribution<double> axis(-half_edge, half_edge);
    const double x = axis(generator), y = axis(generator), z = axis(generator);
    return {x, y, z};
}

ObbTree tilted_tree(TriangleMesh surface, std::size_t leaf_size) {
    const Eigen::Matrix3d R_BP = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    for (Vector3d& vertex : surface.vertices) vertex = R_BP * vertex;
    ObbTree tree = sample::median_tree(surface, leaf_size);
    for (ObbNode& node : tree.nodes) {
        node.center = (R_BP.transpose() * node.center.cast<double>()).cast<float>();
        node.axes = R_BP.cast<float>();
        node.half_extents.array() += 1e-4F;
    }
    return tree;
}

const Vector3d Scene::middle{120, -80, 40};

Scene::Scene(int levels, int loose) : mesh(sample::sphere_surface(middle, 12, levels)) {
    for (int i = 0; i < loose; ++i) {
        const auto first = static_cast<std::int32_t>(mesh.vertices.size());
        const TriangleCorners t = awkward_triangle(point(), generator);
        mesh.vertices.insert(mesh.vertices.end(), t.begin(), t.end());
        mesh.triangles.push_back({first, first + 1, first + 2});
        if (i % 10 == 9) mesh.triangles.push_back(mesh.triangles[mesh.triangles.size() - 3]);
    }
}

Vector3d Scene::point() {
    return middle + in_cube(20, generator);
}

Vector3d Scene::awkward_point(const TriangleCorners& t) {
    switch (generator() % 8) {
        case 0:
            return middle + 50 * (point() - middle);
        case 1:
            return t[0];
        case 2:
            return 0.5 * (t[0] + t[1]);
        case 3:
            return 0.5 * (t[0] + t[1]) + Vector3d(0, 0, 1e-7);
        case 4:
            return (t[0] + t[1] + t[2]) / 3;
        default:
            return point();
    }
}

TriangleCorners awkward_triangle(const Vector3d& about, std::mt19937& generator) {
    TriangleCorners t;
    for (Vector3d& corner : t) corner = about + in_cube(2, generator);
    switch (generator() % 8) {
        case 0:
            t[2] = t[1] + 1e-5 * (t[2] - t[1]);
            break;
        case 1:
            t[2] = 0.5 * (t[0] + t[1]) + 1e-5 * (t[2] - t[1]);
            break;
        case 2:
            t[2] = t[1];
            break;
        case 3:
            t[1] = t[2] = t[0];
            break;
        case 4:
        case 5:
            for (Vector3d& corner : t) corner = corner.array().round();
            break;
        default:
            break;
    }
    return t;
}

TriangleMesh spiky_ball(unsigned seed) {
    TriangleMesh ball = sample::sphere_surface(Vector3d::Zero(), 1, 2);
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> exponent(0, 3);
    for (Vector3d& vertex : ball.vertices)  // on a grid, so that float32 rounds none
        vertex = (3 * 1024 * std::exp2(exponent(generator)) * vertex).array().round() / 1024;
    return ball;
}

}  // namespace palpate
