// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/points/point_shell.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <string>

#include "formats/model/errors.hpp"
#include "runtime/collision/points/farthest_points.hpp"
#include "runtime/collision/triangle_queries.hpp"

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

constexpr std::size_t candidates_per_point = 10;
constexpr double sharp = std::numbers::pi / 6;  // of a full turn, left over by the triangles about a vertex

double area_of(const TriangleCorners& t) {
    return (t[1] - t[0]).cross(t[2] - t[0]).norm() / 2;
}

// Sharp vertices, the sharpest first, at most so many.
std::vector<ShellPoint> sharp_vertices(const TriangleMesh& mesh, std::size_t most) {
    std::vector<double> angles(mesh.vertices.size(), 0);
    std::vector<Vector3d> normals(mesh.vertices.size(), Vector3d::Zero());
    for (const Triangle& triangle : mesh.triangles) {
        const TriangleCorners t = corners_of(mesh, triangle);
        const Vector3d normal = unit_normal(t);
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector3d u = t[(i + 1) % 3] - t[i], v = t[(i + 2) % 3] - t[i];
            const double angle = std::atan2(u.cross(v).norm(), u.dot(v));
            angles[static_cast<std::size_t>(triangle[i])] += angle;
            normals[static_cast<std::size_t>(triangle[i])] += angle * normal;
        }
    }
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < angles.size(); ++i)
        // What is in no triangle is no vertex; normals that cancel have no outside.
        if (angles[i] > 0 && angles[i] < 2 * std::numbers::pi - sharp && normals[i].norm() > 1e-6)
            chosen.push_back(i);
    std::ranges::stable_sort(chosen, {}, [&](std::size_t i) { return angles[i]; });
    std::vector<ShellPoint> points;
    for (std::size_t n = 0; n < std::min(most, chosen.size()); ++n)
        points.push_back(
            {mesh.vertices[chosen[n]].cast<float>(), normals[chosen[n]].normalized().cast<float>()});
    return points;
}

// The n-th point of the sequence R2 in the unit square, folded onto the triangle of two of its corners'
// weights.
Eigen::Vector2d folded_r2(std::size_t n) {
    constexpr double plastic = 1.32471795724474602596;  // the real root of x³ = x + 1
    double whole = 0;
    const double u = std::modf(0.5 + static_cast<double>(n) / plastic, &whole);
    const double v = std::modf(0.5 + static_cast<double>(n) / (plastic * plastic), &whole);
    return u + v > 1 ? Eigen::Vector2d(1 - u, 1 - v) : Eigen::Vector2d(u, v);
}

// Some `count` points of the surface, to each part as many as its share of the area.
std::vector<ShellPoint> spread(const TriangleMesh& mesh, double area, std::size_t count) {
    std::vector<ShellPoint> points;
    points.reserve(count);
    double passed = 0;
    std::size_t next = 0;
    for (const Triangle& triangle : mesh.triangles) {
        const TriangleCorners t = corners_of(mesh, triangle);
        const Vector3d normal = unit_normal(t);
        passed += area_of(t);
        const double due = passed / area * static_cast<double>(count);
        for (; static_cast<double>(next) + 0.5 < due; ++next) {
            if (normal.squaredNorm() == 0) continue;
            const Eigen::Vector2d weights = folded_r2(next);
            const Vector3d p = t[0] + weights[0] * (t[1] - t[0]) + weights[1] * (t[2] - t[0]);
            points.push_back({p.cast<float>(), normal.cast<float>()});
        }
    }
    return points;
}

}  // namespace

PointShell point_shell(const TriangleMesh& mesh, std::size_t count) {
    if (count < fewest_shell_points || count > most_shell_points)
        throw InvalidInput({"a tool's surface", std::to_string(count) + " points asked for",
                            std::to_string(fewest_shell_points) + " to " + std::to_string(most_shell_points),
                            "ask for another number"});
    const double area =
        std::accumulate(mesh.triangles.begin(), mesh.triangles.end(), 0.0,
                        [&](double sum, const Triangle& t) { return sum + area_of(corners_of(mesh, t)); });
    const std::vector<ShellPoint> candidates =
        area > 0 ? spread(mesh, area, candidates_per_point * count) : std::vector<ShellPoint>();
    if (candidates.empty())
        throw InvalidInput({"a tool's surface", "has no area", "a closed surface", "check how it was made"});
    FarthestPoints rest(candidates);
    PointShell shell{sharp_vertices(mesh, count / 4), 0};
    for (const ShellPoint& point : shell.points) rest.choose(point);
    shell.points.reserve(count);
    while (shell.points.size() < count) {
        shell.points.push_back(rest.farthest());
        rest.choose(shell.points.back());
    }
    shell.covering_radius = rest.covering_radius();
    return shell;
}

}  // namespace palpate::collision
