// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/puncture/approaches.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "formats/model/errors.hpp"

namespace palpate::experiments {
namespace {

using namespace collision;
using Eigen::Vector3d;

constexpr double out_of_the_head = 500;  // mm
constexpr double clear = 1e-3;           // mm beside a surface
constexpr double deepest_wall = 300;     // mm

std::vector<double> cumulative_areas(const TriangleMesh& mesh) {
    std::vector<double> sums;
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const auto corner = [&](std::size_t i) { return mesh.vertices[t[i]]; };
        sum += 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
        sums.push_back(sum);
    }
    return sums;
}

// How far along the line from `from` the surface is, mm.
std::optional<double> distance_to(const CollisionSurface& surface, const Vector3d& from,
                                  const Vector3d& direction, double length, double radius = 0) {
    const auto met = surface.sweep_sphere(from, from + length * direction, radius);
    if (!met) return std::nullopt;
    return met->fraction * length;
}

bool is_outer(const CollisionSurface& surface, const Place& place, double tool_radius) {
    const Vector3d far = place.entry - out_of_the_head * place.direction;
    if (distance_to(surface, far, place.direction, out_of_the_head - clear)) return false;
    const auto tool = distance_to(surface, place.entry - Place::free_way * place.direction, place.direction,
                                  Place::free_way, tool_radius);
    return tool && *tool >= Place::free_way - tool_radius - 1;
}

bool is_wall(const CollisionSurface& surface, const Place& place) {
    constexpr double slope = 2.0 / 3, before = 20;
    const Vector3d across = place.direction.unitOrthogonal();
    for (const double aside : {3.0, 6.0})
        for (int i = 0; i < 8; ++i) {
            const Vector3d turned =
                Eigen::AngleAxisd(std::numbers::pi / 4 * i, place.direction) * (aside * across);
            const auto met = distance_to(surface, place.entry + turned - before * place.direction,
                                         place.direction, before + slope * aside);
            if (!met || *met < before - slope * aside) return false;
        }
    return true;
}

}  // namespace

std::vector<Place> draw_places(const TriangleMesh& mesh, const CollisionSurface& surface, double tool_radius,
                               std::size_t count, std::mt19937_64& random) {
    const std::vector<double> areas = cumulative_areas(mesh);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<Place> places;
    for (int failed = 0; places.size() < count; ++failed) {
        if (failed == 100000)
            throw InvalidInput({"the bone's surface", "it has no place that a tool reaches from outside",
                                "a closed surface of a bone, normals outwards",
                                "check it with 'palpate mesh'"});
        const auto drawn = std::ranges::upper_bound(areas, unit(random) * areas.back());
        const Triangle& t = mesh.triangles[drawn - areas.begin()];
        const auto corner = [&](std::size_t i) { return mesh.vertices[t[i]]; };
        const double root = std::sqrt(unit(random)), part = unit(random);
        const Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
        Place place{.entry = (1 - root) * corner(0) + root * (1 - part) * corner(1) + root * part * corner(2),
                    .direction = -normal};
        if (!is_outer(surface, place, tool_radius) || !is_wall(surface, place)) continue;
        const Vector3d below = place.entry + clear * place.direction;
        const auto left = distance_to(surface, below, place.direction, deepest_wall);
        if (!left) continue;  // a bone without an end is not closed here
        place.thickness = clear + *left;
        places.push_back(place);
        failed = 0;
    }
    return places;
}

}  // namespace palpate::experiments
