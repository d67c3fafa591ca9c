// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/whole_tool/tool_spheres.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "formats/model/errors.hpp"
#include "runtime/collision/points/point_shell.hpp"
#include "runtime/collision/triangle_queries.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

constexpr std::size_t points_tried = 3000;
constexpr double least_radius = 0.1;  // mm
// Of a radius: so much of a gap, or of another facet in the way, is how a round surface was cut into
// triangles.
constexpr double of_facets = 0.05;
constexpr double half_weight = 25;  // mm from the tip

struct SurfacePoint {
    Vector3d position, normal;  // mm; outward
};

// The sphere on the inner side of a surface that touches it at `p` and holds no other of its points, of which
// `nearest_to` a centre tells the nearest; its radius is 0 where none was found. Of a surface of facets it
// touches another one beside p.
template <typename NearestTo>
ToolSphere sphere_inside(const SurfacePoint& p, double largest, const NearestTo& nearest_to) {
    constexpr int most_rounds = 60;
    double radius = largest;
    for (int round = 0; round < most_rounds && radius >= least_radius; ++round) {
        const Vector3d centre = p.position - radius * p.normal;
        const SurfacePoint q = nearest_to(centre);
        const double distance = (q.position - centre).norm();
        // Behind a thin wall its other side is near, but looks the other way.
        if (distance >= (1 - of_facets) * radius && q.normal.dot(q.position - centre) > 0)
            return {centre, distance};
        // The one through p and q.
        const Vector3d way = p.position - q.position;
        const double smaller = way.squaredNorm() / (2 * p.normal.dot(way));
        radius = smaller > 0 ? std::min(smaller, (1 - of_facets / 2) * radius) : 0;
    }
    return {};
}

// A surface that is asked for the point nearest to another.
class Skin {
  public:
    explicit Skin(const TriangleMesh& mesh) {
        for (const Triangle& t : mesh.triangles) {
            triangles_.push_back(collision::corners_of(mesh, t));
            const auto& [a, b, c] = triangles_.back();
            centres_.push_back((a + b + c) / 3);
            radii_.push_back(
                std::sqrt(std::max({(a - centres_.back()).squaredNorm(), (b - centres_.back()).squaredNorm(),
                                    (c - centres_.back()).squaredNorm()})));
        }
    }
    SurfacePoint nearest_to(const Vector3d& p) const {
        double nearest = std::numeric_limits<double>::infinity();
        SurfacePoint point{p, Vector3d::Zero()};
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            if ((p - centres_[t]).squaredNorm() > (nearest + radii_[t]) * (nearest + radii_[t])) continue;
            const auto found = collision::closest_point_on_triangle(p, triangles_[t]);
            if (!(found.squared_distance < nearest * nearest)) continue;
            nearest = std::sqrt(found.squared_distance);
            point = {found.point, collision::unit_normal(triangles_[t])};
        }
        return point;
    }

  private:
    std::vector<collision::TriangleCorners> triangles_;
    std::vector<Vector3d> centres_;  // of balls about them
    std::vector<double> radii_;
};

// Grows a sphere as far as its centre may go meanwhile, away from what it touches, by what facets stand
// aside.
void grow(ToolSphere& sphere, const Skin& skin) {
    const Vector3d start = sphere.centre;
    const double farthest = of_facets * sphere.radius, finest = 1e-3 * farthest;
    for (double step = farthest / 2; step > finest;) {
        const Vector3d touched = skin.nearest_to(sphere.centre).position;
        const Vector3d centre = sphere.centre + step * (sphere.centre - touched).normalized();
        const double radius = (skin.nearest_to(centre).position - centre).norm();
        if (radius > sphere.radius && (centre - start).norm() <= farthest)
            sphere = {centre, radius};
        else
            step /= 2;
    }
}

// The sphere that touches one of the surface's points.
struct Candidate {
    SurfacePoint point;
    ToolSphere sphere;
    bool exact = false;  // not only clear of the other points, but of all triangles
};

std::vector<Candidate> candidates_at(const std::vector<SurfacePoint>& points, double largest) {
    const auto nearest_to = [&](const Vector3d& p) {
        return *std::ranges::min_element(
            points, {}, [&](const SurfacePoint& q) { return (q.position - p).squaredNorm(); });
    };
    std::vector<Candidate> candidates;
    for (const SurfacePoint& point : points) {
        const ToolSphere sphere = sphere_inside(point, largest, nearest_to);
        if (sphere.radius >= least_radius) candidates.push_back({point, sphere});
    }
    return candidates;
}

// How far points of the surface are from the nearest sphere that was chosen.
class Gaps {
  public:
    Gaps(const std::vector<SurfacePoint>& points, double farthest) : gaps_(points.size(), farthest) {
        for (const SurfacePoint& point : points) {
            points_.push_back(point.position);
            weights_.push_back(1 / (1 + points_.back().squaredNorm() / (half_weight * half_weight)));
        }
    }
    // What a sphere takes off the sum of their weighted squares.
    double taken_by(const ToolSphere& sphere) const {
        double taken = 0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const double gap = gap_to(sphere, i);
            if (gap < gaps_[i]) taken += weights_[i] * (gaps_[i] * gaps_[i] - gap * gap);
        }
        return taken;
    }
    void take(const ToolSphere& sphere) {
        for (std::size_t i = 0; i < points_.size(); ++i) gaps_[i] = std::min(gaps_[i], gap_to(sphere, i));
    }
    // mm, from the spheres that were taken.
    double largest(const std::vector<ToolSphere>& spheres) const {
        double largest = 0;
        for (const Vector3d& point : points_) {
            double nearest = std::numeric_limits<double>::infinity();
            for (const auto& [centre, radius] : spheres)
                nearest = std::min(nearest, std::abs((point - centre).norm() - radius));
            largest = std::max(largest, nearest);
        }
        return largest;
    }

  private:
    double gap_to(const ToolSphere& sphere, std::size_t i) const {
        const double gap = std::abs((points_[i] - sphere.centre).norm() - sphere.radius);
        return std::max(0.0, gap - of_facets * sphere.radius);
    }

    std::vector<Vector3d> points_;
    std::vector<double> weights_, gaps_;
};

// Whether two spheres touch a common plane at places hardly apart: together they say no more than one.
bool are_crowded(const ToolSphere& a, const ToolSphere& b) {
    constexpr double closest = 0.5;  // of the smaller's radius
    const double least = closest * std::min(a.radius, b.radius), difference = a.radius - b.radius;
    return (a.centre - b.centre).squaredNorm() < least * least + difference * difference;
}

double diagonal_of(const TriangleMesh& surface) {
    Eigen::AlignedBox3d box;
    for (const Vector3d& vertex : surface.vertices) box.extend(vertex);
    return box.diagonal().norm();
}

}  // namespace

SphereFilling fill_with_spheres(const TriangleMesh& surface, std::size_t most) {
    std::vector<SurfacePoint> points;
    for (const auto& [position, normal] : collision::point_shell(surface, points_tried).points)
        points.push_back({position.cast<double>(), normal.cast<double>().normalized()});
    const double diagonal = diagonal_of(surface);
    const Skin skin(surface);
    Gaps gaps(points, diagonal);
    std::vector<Candidate> candidates = candidates_at(points, diagonal / 2);
    // What one takes off only falls as others are chosen, so that most need not be asked again (Minoux 1978).
    struct Promise {
        double taken = 0;
        std::size_t candidate = 0, chosen = 0;  // when that was asked
        bool operator<(const Promise& other) const {
            return taken < other.taken || (taken == other.taken && candidate > other.candidate);
        }
    };
    std::priority_queue<Promise> promises;
    const auto promise = [&](std::size_t i, std::size_t chosen) {
        if (const double taken = gaps.taken_by(candidates[i].sphere); taken > 0)
            promises.push({taken, i, chosen});
    };
    for (std::size_t i = 0; i < candidates.size(); ++i) promise(i, 0);
    SphereFilling filling;
    while (filling.spheres.size() < most && !promises.empty()) {
        const Promise best = promises.top();
        promises.pop();
        Candidate& candidate = candidates[best.candidate];
        const auto crowds = [&](const ToolSphere& chosen) { return are_crowded(chosen, candidate.sphere); };
        if (std::ranges::any_of(filling.spheres, crowds)) continue;
        if (best.chosen == filling.spheres.size() && candidate.exact) {
            filling.spheres.push_back(candidate.sphere);
            gaps.take(filling.spheres.back());
            continue;
        }
        if (best.chosen == filling.spheres.size()) {
            // It may have been cut down by a facet, so begins a little larger.
            candidate.sphere = sphere_inside(candidate.point, candidate.sphere.radius / (1 - of_facets),
                                             [&](const Vector3d& p) { return skin.nearest_to(p); });
            candidate.exact = true;
            if (candidate.sphere.radius < least_radius) continue;
            grow(candidate.sphere, skin);
        }
        promise(best.candidate, filling.spheres.size());
    }
    if (filling.spheres.empty())
        throw InvalidInput({"instrument", "no room inside for a sphere of a tenth of a millimetre",
                            "a closed surface in mm whose triangles look outward",
                            "check its unit and its normals"});
    filling.largest_gap = gaps.largest(filling.spheres);
    return filling;
}

std::vector<ToolSphere> rod_spheres(double radius, double length, std::size_t most) {
    const double behind = std::min(static_cast<double>(most - 1), std::ceil(length / radius));
    std::vector<ToolSphere> spheres{{Vector3d::Zero(), radius}};
    for (double k = 1; k <= behind; ++k) spheres.push_back({{0, 0, length * k / behind}, radius});
    return spheres;
}

}  // namespace palpate::haptics
