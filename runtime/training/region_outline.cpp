// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/region_outline.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "formats/model/regions.hpp"

namespace palpate::training {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double outline_step = 1;  // mm, between points of an outline

double cross(const Vector2d& a, const Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// Counter-clockwise. Source: Andrew 1979, the monotone chain.
std::vector<Vector2d> convex_hull(std::vector<Vector2d> points) {
    std::ranges::sort(points, [](const Vector2d& a, const Vector2d& b) {
        return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
    });
    std::vector<Vector2d> hull;
    const auto add_chain = [&](auto first, auto last) {
        const std::size_t before = hull.size();
        for (; first != last; ++first) {
            while (hull.size() >= before + 2 &&
                   cross(hull.back() - hull[hull.size() - 2], *first - hull.back()) <= 0)
                hull.pop_back();
            hull.push_back(*first);
        }
        hull.pop_back();  // the next chain begins with it
    };
    add_chain(points.begin(), points.end());
    add_chain(points.rbegin(), points.rend());
    return hull;
}

// The surface as it is seen along the last of three axes, from its positive side.
class SeenSurface {
  public:
    SeenSurface(const TriangleMesh& surface, const Vector3d& origin, const Vector3d& up) : origin_(origin) {
        axes_.col(2) = up;
        axes_.col(0) = up.unitOrthogonal();
        axes_.col(1) = up.cross(axes_.col(0));
        for (const auto& triangle : surface.triangles) {
            const std::array corners{across(surface.vertices[triangle[0]]),
                                     across(surface.vertices[triangle[1]]),
                                     across(surface.vertices[triangle[2]])};
            if (doubled_area(corners) > 0) facing_.push_back(corners);
        }
    }

    // Two coordinates across the view, and the height.
    Vector3d across(const Vector3d& p) const { return axes_.transpose() * (p - origin_); }

    // The place of the surface at `at` whose height is nearest to the origin's, p_P.
    std::optional<Vector3d> below(const Vector2d& at) const {
        double best = std::numeric_limits<double>::max();
        for (const auto& [a, b, c] : facing_) {
            const double in_a = cross(b.head<2>() - at, c.head<2>() - at),
                         in_b = cross(c.head<2>() - at, a.head<2>() - at),
                         in_c = cross(a.head<2>() - at, b.head<2>() - at);
            if (in_a < 0 || in_b < 0 || in_c < 0) continue;
            const double height = (in_a * a.z() + in_b * b.z() + in_c * c.z()) / (in_a + in_b + in_c);
            if (std::abs(height) < std::abs(best)) best = height;
        }
        if (best == std::numeric_limits<double>::max()) return std::nullopt;
        return origin_ + axes_ * Vector3d(at.x(), at.y(), best);
    }

  private:
    using Corners = std::array<Vector3d, 3>;
    static double doubled_area(const Corners& t) {
        return cross((t[1] - t[0]).head<2>(), (t[2] - t[0]).head<2>());
    }

    Vector3d origin_;
    Eigen::Matrix3d axes_;
    std::vector<Corners> facing_;
};

// Of the surface within `radius` of a place; unit.
Vector3d mean_normal(const TriangleMesh& surface, const Vector3d& place, double radius) {
    Vector3d sum = Vector3d::Zero();
    for (const auto& triangle : surface.triangles) {
        const Vector3d &a = surface.vertices[triangle[0]], &b = surface.vertices[triangle[1]],
                       &c = surface.vertices[triangle[2]];
        if (((a + b + c) / 3 - place).norm() <= radius) sum += (b - a).cross(c - a);
    }
    return sum.normalized();
}

// A region's nodes and the ball about their mean that holds them.
struct Extent {
    std::vector<Vector3d> nodes;
    Vector3d middle = Vector3d::Zero();
    double radius = 0;
};

Extent extent_of(const TetMesh& mesh, std::int32_t region) {
    Extent extent;
    for (const std::int32_t node : nodes_of_region(mesh, region))
        extent.nodes.push_back(mesh.rest_positions[node]);
    for (const Vector3d& node : extent.nodes)
        extent.middle += node / static_cast<double>(extent.nodes.size());
    for (const Vector3d& node : extent.nodes)
        extent.radius = std::max(extent.radius, (node - extent.middle).norm());
    return extent;
}

// As one sees it who looks straight down at a place; nothing where the surface about it has no side.
std::optional<SeenSurface> seen_at(const TriangleMesh& surface, const Vector3d& place, double radius) {
    const Vector3d up = mean_normal(surface, place, radius);
    if (up.isZero()) return std::nullopt;
    return SeenSurface(surface, place, up);
}

}  // namespace

Vector3d place_above(const DeformableBody& body, std::int32_t region, const Vector3d& near) {
    constexpr int most_rounds = 10;
    constexpr double settled = 0.1;  // mm
    const Extent extent = extent_of(body.mesh, region);
    Vector3d place = near;
    for (int round = 0; round < most_rounds; ++round) {
        const auto seen = seen_at(body.boundary.surface, place, extent.radius);
        const auto next = seen ? seen->below(seen->across(extent.middle).head<2>()) : std::nullopt;
        if (!next) break;
        const double moved = (*next - std::exchange(place, *next)).norm();
        if (moved < settled) break;
    }
    return place;
}

std::vector<Vector3d> region_outline(const DeformableBody& body, std::int32_t region, const Vector3d& above) {
    const Extent extent = extent_of(body.mesh, region);
    const auto surface = seen_at(body.boundary.surface, above, extent.radius);
    if (!surface) return {};
    std::vector<Vector2d> shadow;
    for (const Vector3d& node : extent.nodes) shadow.emplace_back(surface->across(node).head<2>());
    const std::vector<Vector2d> hull = convex_hull(std::move(shadow));
    std::vector<Vector3d> outline;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Vector2d &from = hull[i], &to = hull[(i + 1) % hull.size()];
        const double pieces = std::ceil((to - from).norm() / outline_step);
        for (double piece = 0; piece < pieces; ++piece)
            if (const auto point = surface->below(from + (to - from) * (piece / pieces)))
                outline.push_back(*point);
    }
    return outline;
}

double distance_to_outline(const std::vector<Vector3d>& outline, const Vector3d& p) {
    double distance = (p - outline.front()).norm();
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vector3d &from = outline[i], &to = outline[(i + 1) % outline.size()];
        const Vector3d way = to - from;
        const double along = way.squaredNorm() > 0 ? (p - from).dot(way) / way.squaredNorm() : 0;
        distance = std::min(distance, (from + std::clamp(along, 0.0, 1.0) * way - p).norm());
    }
    return distance;
}

}  // namespace palpate::training
