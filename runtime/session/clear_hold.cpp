// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/clear_hold.hpp"

#include <algorithm>

#include "formats/model/geometry/spiral_direction.hpp"
#include "runtime/collision/free_part.hpp"

namespace palpate::session {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int directions = 1500;   // over the half space: 4 degrees apart
constexpr double room_of_eye = 4;  // mm, between it and the shaft

// How thick a tool is at most, a radius, mm.
double thickness(const Case& patient_case) {
    if (!has_instrument(patient_case)) return patient_case.haptics.tool_radius;
    double widest = 0;
    for (const Vector3d& vertex : patient_case.tool->surface.vertices)
        widest = std::max(widest, vertex.head<2>().norm());
    return widest;
}

double distance_to_ray(const Vector3d& p, const Vector3d& from, const Vector3d& way) {
    const double along = std::max(0.0, (p - from).dot(way));
    return (p - from - along * way).norm();
}

}  // namespace

Quaterniond clear_hold(const Case& patient_case, std::span<const collision::CollisionSurface* const> bodies,
                       const Vector3d& tip, const Vector3d& normal, const std::optional<Vector3d>& eye) {
    const double length = tool_length(patient_case), radius = thickness(patient_case);
    const Quaterniond along_normal = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), normal);
    Quaterniond best = along_normal;
    double most = -1;
    for (int i = -1; i < directions && most < 1; ++i) {
        const Vector3d way = i < 0 ? normal : along_normal * spiral_direction(i, directions);
        if (eye && distance_to_ray(*eye, tip, way) < radius + room_of_eye) continue;
        if (const double part = collision::free_part(bodies, tip, tip + length * way, radius); part > most) {
            most = part;
            best = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), way);
        }
    }
    return best;
}

}  // namespace palpate::session
