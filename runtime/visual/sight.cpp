// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/sight.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::visual {
namespace {

// Moller, Trumbore 1997: does the segment from a along `way` cross the triangle?
bool crosses(const TriangleMesh& mesh, const Triangle& t, const Eigen::Vector3d& a,
             const Eigen::Vector3d& way) {
    const auto corner = [&](std::size_t i) -> const Eigen::Vector3d& { return mesh.vertices[t[i]]; };
    const Eigen::Vector3d e1 = corner(1) - corner(0), e2 = corner(2) - corner(0);
    const Eigen::Vector3d p = way.cross(e2);
    const double det = e1.dot(p);
    if (det == 0) return false;
    const Eigen::Vector3d s = a - corner(0), q = s.cross(e1);
    const double u = s.dot(p) / det, v = way.dot(q) / det, along = e2.dot(q) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && along > 0 && along < 1;
}

bool blocked_by(const TriangleMesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& way) {
    return std::ranges::any_of(mesh.triangles, [&](const Triangle& t) { return crosses(mesh, t, a, way); });
}

}  // namespace

Eigen::Vector3d Sight::eye() const {
    return focus + toward_eye * (field / 2 / std::tan(view_angle_deg * std::numbers::pi / 360));
}

Eigen::Matrix3d Sight::axes() const {
    const bool along_body = std::abs(toward_eye.z()) > 0.9;
    const Eigen::Vector3d head = along_body ? Eigen::Vector3d(0, -1, 0) : Eigen::Vector3d(0, 0, 1);
    const Eigen::Vector3d right = head.cross(toward_eye).normalized();
    Eigen::Matrix3d axes;
    axes << right, toward_eye.cross(right), toward_eye;
    return axes;
}

Sight choose_sight(const Case& patient_case, const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
    constexpr double toward_body = 0.35;  // of the way from the target to the body's centre
    constexpr double tilt = 0.7;          // 35 degrees
    constexpr double widest = 260;        // mm: a head
    constexpr double clear_of_point = 1;  // mm: the surface itself does not block
    const Eigen::Vector3d up =
        std::abs(normal.z()) < 0.8 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d(-Eigen::Vector3d::UnitY());
    const Eigen::Vector3d sideways = (up - normal * normal.dot(up)).normalized();

    Sight sight;
    sight.target = point;
    sight.toward_eye = (normal + tilt * sideways).normalized();
    Eigen::AlignedBox3d box;
    if (!patient_case.deformable_bodies.empty())
        for (const Eigen::Vector3d& p : patient_case.deformable_bodies.front().boundary.surface.vertices)
            box.extend(p);
    else
        for (const Eigen::Vector3d& p : patient_case.rigid_bodies.front().surface.vertices) box.extend(p);
    sight.field = std::min(widest, 0.8 * box.sizes().maxCoeff());
    sight.close_up = {point};
    sight.close_up_radius = sight.field / 2;
    sight.focus = point + toward_body * (box.center() - point);

    const Eigen::Vector3d start = point + normal * clear_of_point;
    const Eigen::Vector3d way = sight.toward_eye * 1000;
    for (const RigidBody& body : patient_case.rigid_bodies)
        sight.blocked = sight.blocked || blocked_by(body.surface, start, way);
    for (const DeformableBody& body : patient_case.deformable_bodies)
        sight.blocked = sight.blocked || blocked_by(body.boundary.surface, start, way);
    return sight;
}

}  // namespace palpate::visual
