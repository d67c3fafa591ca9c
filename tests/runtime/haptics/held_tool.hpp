// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

#include "formats/model/body.hpp"
#include "runtime/haptics/contact/god_object.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/elastic_cube.hpp"

namespace palpate {

/// A device whose tool's tip is at `p` (mm), its shaft along `shaft` (unit, or zero).
inline realtime::DeviceState held_at(const Eigen::Vector3d& p,
                                     const Eigen::Vector3d& shaft = Eigen::Vector3d::Zero()) {
    realtime::DeviceState state;
    state.position = {p[0], p[1], p[2]};
    state.shaft = {shaft[0], shaft[1], shaft[2]};
    return state;
}

inline Eigen::Vector3d force_of(const TickResult& result) {
    return Eigen::Map<const Eigen::Vector3d>(result.force.data());
}

inline Eigen::Vector3d tool_of(const TickResult& result) {
    return Eigen::Map<const Eigen::Vector3d>(result.tool_position.data());
}

/// What the contacts press with, and what friction adds, N.
inline double press_of(const TickResult& result) {
    double sum = 0;
    for (const Contact& contact : result.active_contacts()) sum += static_cast<double>(contact.force);
    return sum;
}
inline Eigen::Vector3d drag_of(const TickResult& result) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Contact& contact : result.active_contacts())
        sum += Eigen::Map<const Eigen::Vector3f>(contact.friction.data()).cast<double>();
    return sum;
}

/// A box from `low` to `high` (mm), 4 by 4 by 4 squares of two triangles.
inline TriangleMesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    TriangleMesh mesh = boundary_surface(sample::cube_mesh(4, 1)).surface;
    for (Eigen::Vector3d& v : mesh.vertices) v = low + v.cwiseProduct(high - low);
    return mesh;
}

inline RigidBody rigid(const std::string& name, const TriangleMesh& surface) {
    return {.name = name, .surface = surface, .obb_tree = sample::median_tree(surface, 4)};
}

/// The same body elsewhere.
inline DeformableBody moved(DeformableBody body, const Eigen::Vector3d& by) {
    for (Eigen::Vector3d& p : body.mesh.rest_positions) p += by;
    for (Eigen::Vector3d& p : body.boundary.surface.vertices) p += by;
    body.obb_tree = sample::median_tree(body.boundary.surface, 4);
    return body;
}

/// A tool of 1 mm on 0.5 N/mm, with limits wide enough not to show.
inline HapticSettings wide_limits() {
    return {.tool_radius = 1, .coupling_stiffness = 0.5, .max_force = 99, .max_force_rate = 99};
}

/// A rigid plate with its top at z = 0, from -20 to 20 mm along x and y.
inline Case plate() {
    Case c;
    c.name = "plate";
    c.rigid_bodies.push_back(rigid("plate", box({-20, -20, -10}, {20, 20, 0})));
    c.haptics = wide_limits();
    return c;
}

/// The true elastic cube, [0, 20] mm, held at z = 0, of cells^3 cells.
inline Case soft_cube(int cells) {
    Case c;
    c.name = "cube";
    c.deformable_bodies.push_back(sample::true_elastic_cube(cells));
    c.haptics = wide_limits();
    return c;
}

}  // namespace palpate
