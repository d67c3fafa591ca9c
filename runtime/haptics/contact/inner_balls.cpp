// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/inner_balls.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>

#include "runtime/collision/triangle_queries.hpp"

// A sphere of radius r that is pressed by d into tissue over a sharp edge slips off it as soon as d > r: the
// tissue gives way sideways faster than the sphere's normal turns. Over an edge that is round with radius R
// it slips off beyond r + R, so it turns from one face of a smooth organ's mesh to the next little by little.
//
// Where balls of radius R about x - R m, x a vertex, are to touch the planes of the triangles t about it, of
// unit normals n_t, m must have n_t . m = 1 for all of them. It has in the least squares, weighted by the
// triangles' angles, and of those it is the nearest to their mean normal.

namespace palpate::haptics {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Radii at most: in the radius of the tool, which does not slip off the edges of a bent surface that it is
// pressed into as deep as that; and in mean edges about a vertex, with how far surfaces may be off for it.
constexpr double tool_radii = 3, most_edges = 2, most_off = 0.02;
constexpr double thickness_share = 1.0 / 3;  // of the body's thickness there, at most

// Triangles of balls' centres have this share of the area of their own at least, and radii differ along an
// edge by this share of its length at most.
constexpr double area_kept = 0.16, steepest = 0.25;
constexpr double shrinks = 0.9;
constexpr int most_passes = 200;     // by which what shrinks all the time is nothing
constexpr double tangential = 1e-3;  // weight of staying near the mean normal
constexpr double skin = 1e-3;        // of the way: where a ray leaves its own triangles

// What is known about a vertex from the triangles that hold it.
struct Surroundings {
    Matrix3d squares = Matrix3d::Zero();
    Vector3d sum = Vector3d::Zero();
    double angle = 0, edges = 0;
    int edge_count = 0;
};

collision::TriangleCorners corners_of(const TriangleMesh& mesh, const Triangle& t) {
    return {mesh.vertices[static_cast<std::size_t>(t[0])], mesh.vertices[static_cast<std::size_t>(t[1])],
            mesh.vertices[static_cast<std::size_t>(t[2])]};
}

std::vector<Surroundings> surroundings_of(const TriangleMesh& mesh) {
    std::vector<Surroundings> all(mesh.vertices.size());
    for (const Triangle& t : mesh.triangles) {
        const collision::TriangleCorners corners = corners_of(mesh, t);
        const Vector3d normal = collision::unit_normal(corners);
        for (std::size_t i = 0; i < 3; ++i) {
            Surroundings& here = all[static_cast<std::size_t>(t[i])];
            const double angle = collision::angle_about(corners[i], corners);
            here.squares += angle * normal * normal.transpose();
            here.sum += angle * normal;
            here.angle += angle;
            here.edges += (corners[(i + 1) % 3] - corners[i]).norm();
            ++here.edge_count;
        }
    }
    return all;
}

// Zero where no triangle about a vertex has area.
Vector3d direction_of(const Surroundings& at) {
    if (!(at.angle > 0)) return Vector3d::Zero();
    const Vector3d mean = at.sum.normalized();
    const Matrix3d squares = at.squares / at.angle + tangential * Matrix3d::Identity();
    return mean + squares.ldlt().solve((at.sum - at.squares * mean) / at.angle);
}

}  // namespace

std::vector<InnerBall> inner_balls(const TriangleMesh& mesh, const collision::CollisionSurface& surface,
                                   std::span<const std::int32_t> blocks, double tool_radius) {
    const std::size_t count = mesh.vertices.size();
    const std::vector<Surroundings> surroundings = surroundings_of(mesh);
    std::vector<Vector3d> directions(count);
    std::vector<double> radii(count, 0), off(count, 0);
    for (std::size_t v = 0; v < count; ++v) directions[v] = direction_of(surroundings[v]);
    // How far a ball of unit radius is off the planes that it should touch, and below the vertex.
    for (const Triangle& t : mesh.triangles) {
        const Vector3d normal = collision::unit_normal(corners_of(mesh, t));
        for (const std::int32_t corner : t) {
            if (normal.isZero()) continue;
            const auto v = static_cast<std::size_t>(corner);
            off[v] = std::max({off[v], std::abs(normal.dot(directions[v]) - 1), directions[v].norm() - 1});
        }
    }
    for (std::size_t v = 0; v < count; ++v) {
        if (directions[v].isZero()) continue;
        const double edge = surroundings[v].edges / surroundings[v].edge_count;
        radii[v] = std::min(tool_radii * tool_radius, most_edges * edge);
        if (off[v] * radii[v] > most_off * edge) radii[v] = most_off * edge / off[v];
        const Vector3d way = -radii[v] / thickness_share * directions[v].normalized();
        const Vector3d& vertex = mesh.vertices[v];
        if (const auto back = surface.sweep_sphere(vertex + skin * way, vertex + way, 0))
            radii[v] *= back->fraction;
    }
    // What is held stays as it is: a sphere may press thin tissue down to it, and so meet it from its back;
    // and as spheres do not sink into it, they tilt what is held in part, with which balls do not turn.
    const auto held = [&](std::int32_t v) { return blocks[static_cast<std::size_t>(v)] < 0; };
    for (const Triangle& t : mesh.triangles)
        if (std::ranges::any_of(t, held))
            for (const std::int32_t corner : t) radii[static_cast<std::size_t>(corner)] = 0;
    bool smaller = true;
    for (int pass = 0; smaller && pass < most_passes; ++pass) {
        smaller = false;
        for (const Triangle& t : mesh.triangles) {
            const collision::TriangleCorners own = corners_of(mesh, t);
            collision::TriangleCorners inner = own;
            for (std::size_t i = 0; i < 3; ++i) {
                const auto v = static_cast<std::size_t>(t[i]),
                           next = static_cast<std::size_t>(t[(i + 1) % 3]);
                inner[i] -= radii[v] * directions[v];
                const double most = steepest * (own[(i + 1) % 3] - own[i]).norm();
                if (std::abs(radii[v] - radii[next]) <= most / shrinks) continue;
                (radii[v] > radii[next] ? radii[v] : radii[next]) = std::min(radii[v], radii[next]) + most;
                smaller = true;
            }
            const Vector3d area = (own[1] - own[0]).cross(own[2] - own[0]);
            if ((inner[1] - inner[0]).cross(inner[2] - inner[0]).dot(area) >= area_kept * area.squaredNorm())
                continue;
            for (const std::int32_t corner : t) radii[static_cast<std::size_t>(corner)] *= shrinks;
            smaller = true;
        }
    }
    std::vector<InnerBall> balls(count);
    for (std::size_t v = 0; v < count; ++v) balls[v] = {-radii[v] * directions[v], radii[v]};
    return balls;
}

}  // namespace palpate::haptics
