// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/inside/passage_sight.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/model/geometry/spiral_direction.hpp"
#include "runtime/collision/free_part.hpp"

namespace palpate::visual {
namespace {

using collision::CollisionSurface;
using Eigen::Vector3d;
using Surfaces = std::span<const CollisionSurface* const>;

constexpr int directions = 1500;                // over the half space: 4 degrees apart
constexpr double lens_radius = 1.5;             // mm
constexpr double shortest = 15, farthest = 45;  // mm, of the way from the target to the eye
constexpr double grazing_weight = 0.4;          // what a way along the wall counts of one straight off it
constexpr double wide_angle_deg = 70;
constexpr double close_up_radius = 8;  // mm: half a nasal passage

double room_at(Surfaces surfaces, const Vector3d& place) {
    double room = farthest;
    for (const CollisionSurface* surface : surfaces)
        if (const auto nearest = surface->closest_point(place, room)) room = nearest->distance;
    return room;
}

}  // namespace

std::optional<Sight> choose_passage_sight(Surfaces surfaces, const Vector3d& point, const Vector3d& normal) {
    const Vector3d start = point + 1.1 * lens_radius * normal;
    const auto turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), normal);
    double most = 0, longest = 0;
    Vector3d toward_eye = normal;
    for (int i = 0; i < directions; ++i) {
        const Vector3d local = spiral_direction(i, directions);
        const double weight = grazing_weight + (1 - grazing_weight) * local.z();
        if (farthest * weight <= most) break;  // those that follow are more grazing still
        const Vector3d way = turn * local;
        const double length =
            farthest * collision::free_part(surfaces, start, start + farthest * way, lens_radius);
        const double worth = length * weight;
        if (length < shortest || worth <= most) continue;
        most = worth;
        longest = length;
        toward_eye = way;
    }
    if (longest == 0) return std::nullopt;

    constexpr int steps = 16;
    constexpr double nearest_share = 0.7;
    Vector3d eye = start;
    double widest = 0;
    for (int i = 0; i <= steps; ++i) {
        const double share = nearest_share + (1 - nearest_share) * i / steps;
        const Vector3d place = start + share * longest * toward_eye;
        if (const double room = room_at(surfaces, place); room >= widest) {
            widest = room;
            eye = place;
        }
    }
    Sight sight;
    sight.target = sight.focus = point;
    sight.toward_eye = (eye - point).normalized();
    sight.view_angle_deg = wide_angle_deg;
    sight.field = 2 * (eye - point).norm() * std::tan(wide_angle_deg * std::numbers::pi / 360);
    sight.inside = true;
    sight.close_up = {eye, point};
    sight.close_up_radius = close_up_radius;
    return sight;
}

}  // namespace palpate::visual
