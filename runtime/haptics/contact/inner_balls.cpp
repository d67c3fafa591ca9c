// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/inner_balls.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

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

using namespace collision;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Radii at most: in the radius of the tool, which does not slip off the edges of a bent surface that it is
// pressed into as deep as that; in mean edges about a vertex; and as a share of the body's thickness there.
constexpr double tool_radii = 3, most_edges = 2, thickness_share = 1.0 / 3;
// How far balls may be off for it, in mean edges and in mm: where edges are blunt, bent by 57 degrees and
// less, which of an organ are the mesh's own. The sharper they are, the less, for those are a body's.
constexpr double most_off = 0.1, most_off_blunt = 0.25, most_off_sharp = 0.05;
constexpr double off_blunt = 0.14;  // of a ball of unit radius
// Triangles of balls' centres have this share of the area of their own at least, and radii differ along an
// edge by this share of its length at most, or a tenth more.
constexpr double area_kept = 0.16, steepest = 0.45;
constexpr double shrinks = 0.9;
constexpr int most_passes = 200;     // by which what shrinks all the time is nothing
constexpr double tangential = 1e-3;  // weight of staying near the mean normal
constexpr double skin = 1e-3;        // of the way: where a ray leaves its own triangles

// What the triangles about a vertex say.
struct Place {
    Matrix3d squares = Matrix3d::Zero();  // of their normals, and
    Vector3d sum = Vector3d::Zero();      // these, weighted by angles
    double angle = 0;                     // of all together
    double edges = 0;                     // mm, all together
    int edge_count = 0;
    Vector3d direction = Vector3d::Zero();  // m; zero where no triangle has area
    double off = 0;  // how far a ball of unit radius is off their planes, or below the vertex
    double radius = 0;
};

std::size_t index(std::int32_t vertex) {
    return static_cast<std::size_t>(vertex);
}

Vector3d direction_at(const Place& place) {
    if (!(place.angle > 0)) return Vector3d::Zero();
    const Vector3d mean = place.sum.normalized();
    const Matrix3d squares = place.squares / place.angle + tangential * Matrix3d::Identity();
    return mean + squares.ldlt().solve((place.sum - place.squares * mean) / place.angle);
}

std::vector<Place> places_of(const TriangleMesh& mesh) {
    std::vector<Place> places(mesh.vertices.size());
    for (const Triangle& t : mesh.triangles) {
        const TriangleCorners corners = corners_of(mesh, t);
        const Vector3d normal = unit_normal(corners);
        for (std::size_t i = 0; i < 3; ++i) {
            Place& place = places[index(t[i])];
            const double angle = angle_about(corners[i], corners);
            place.squares += angle * normal * normal.transpose();
            place.sum += angle * normal;
            place.angle += angle;
            place.edges += (corners[(i + 1) % 3] - corners[i]).norm();
            ++place.edge_count;
        }
    }
    for (Place& place : places) place.direction = direction_at(place);
    for (const Triangle& t : mesh.triangles) {
        const Vector3d normal = unit_normal(corners_of(mesh, t));
        if (normal.isZero()) continue;
        for (const std::int32_t vertex : t) {
            Place& place = places[index(vertex)];
            place.off =
                std::max({place.off, std::abs(normal.dot(place.direction) - 1), place.direction.norm() - 1});
        }
    }
    return places;
}

// In mm.
double most_off_at(double off) {
    return off > off_blunt ? std::max(most_off_blunt * off_blunt / off, most_off_sharp) : most_off_blunt;
}

double widest_at(const Place& place, const Vector3d& vertex, const CollisionSurface& surface,
                 double tool_radius) {
    if (place.direction.isZero()) return 0;
    const double edge = place.edges / place.edge_count;
    const double may_be_off = std::min(most_off * edge, most_off_at(place.off));
    double radius = std::min(tool_radii * tool_radius, most_edges * edge);
    if (place.off * radius > may_be_off) radius = may_be_off / place.off;
    const Vector3d way = -radius / thickness_share * place.direction.normalized();
    const auto back = surface.sweep_sphere(vertex + skin * way, vertex + way, 0);
    return back ? back->fraction * radius : radius;
}

// What is held stays as it is: a sphere may press thin tissue down to it, and so meet it from its back; and
// as spheres do not sink into it, they tilt what is held in part, with which balls do not turn.
void keep_what_is_held(std::vector<Place>& places, const TriangleMesh& mesh,
                       std::span<const std::int32_t> blocks) {
    const auto held = [&](std::int32_t vertex) { return blocks[index(vertex)] < 0; };
    for (const Triangle& t : mesh.triangles)
        if (std::ranges::any_of(t, held))
            for (const std::int32_t vertex : t) places[index(vertex)].radius = 0;
}

// Makes one of two balls smaller if they are too unlike.
bool liken(Place& a, Place& b, double length) {
    Place& larger = a.radius > b.radius ? a : b;
    const double less = std::min(a.radius, b.radius), most = steepest * length;
    if (larger.radius - less <= most / shrinks) return false;
    larger.radius = less + most;
    return true;
}

// Makes a triangle's balls smaller if their centres' triangle has hardly any area, or looks the other way.
bool keep_upright(std::vector<Place>& places, const TriangleMesh& mesh, const Triangle& t) {
    const TriangleCorners own = corners_of(mesh, t);
    TriangleCorners inner = own;
    for (std::size_t i = 0; i < 3; ++i)
        inner[i] -= places[index(t[i])].radius * places[index(t[i])].direction;
    const Vector3d area = (own[1] - own[0]).cross(own[2] - own[0]);
    if ((inner[1] - inner[0]).cross(inner[2] - inner[0]).dot(area) >= area_kept * area.squaredNorm())
        return false;
    for (const std::int32_t vertex : t) places[index(vertex)].radius *= shrinks;
    return true;
}

bool make_smaller(std::vector<Place>& places, const TriangleMesh& mesh) {
    bool smaller = false;
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t from = index(t[i]), to = index(t[(i + 1) % 3]);
            smaller |= liken(places[from], places[to], (mesh.vertices[to] - mesh.vertices[from]).norm());
        }
        smaller |= keep_upright(places, mesh, t);
    }
    return smaller;
}

}  // namespace

std::vector<InnerBall> inner_balls(const TriangleMesh& mesh, const CollisionSurface& surface,
                                   std::span<const std::int32_t> blocks, double tool_radius) {
    std::vector<Place> places = places_of(mesh);
    for (std::size_t v = 0; v < places.size(); ++v)
        places[v].radius = widest_at(places[v], mesh.vertices[v], surface, tool_radius);
    keep_what_is_held(places, mesh, blocks);
    for (int pass = 0; pass < most_passes && make_smaller(places, mesh); ++pass) {
    }
    std::vector<InnerBall> balls;
    for (const Place& place : places) balls.push_back({-place.radius * place.direction, place.radius});
    return balls;
}

}  // namespace palpate::haptics
