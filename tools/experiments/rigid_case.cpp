// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/rigid_case.hpp"

#include <utility>

#include "tools/obb/build_obb_tree.hpp"

namespace palpate::experiments {

Case rigid_case(const std::string& name, TriangleMesh surface, const HapticSettings& haptics) {
    Case made;
    made.name = name;
    RigidBody& body = made.rigid_bodies.emplace_back();
    body.name = name;
    body.surface = std::move(surface);
    body.obb_tree = obb::build_obb_tree(body.surface);
    made.haptics = haptics;
    return made;
}

TriangleMesh plate_surface(double thickness) {
    TriangleMesh plate;
    for (const double z : {-thickness, 0.0})
        for (const double y : {-100.0, 100.0})
            for (const double x : {-100.0, 100.0}) plate.vertices.emplace_back(x, y, z);
    plate.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                       {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return plate;
}

}  // namespace palpate::experiments
