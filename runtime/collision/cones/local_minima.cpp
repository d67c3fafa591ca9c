// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/cones/local_minima.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "runtime/collision/segment_queries.hpp"

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

class Finder {
  public:
    Finder(const FeaturePair& pair, double within, PairMinima& found) noexcept
        : pair_(pair), within_(within), found_(found) {}

    void find() noexcept {
        found_.count = 0;
        const TriangleFeatures &of_a = pair_.a.of(pair_.triangle_a), &of_b = pair_.b.of(pair_.triangle_b);
        for (std::size_t i = 0; i < 3; ++i) {
            if (has_bit(of_a.own_vertices, i)) vertex_of_a(of_a, of_b, i);
            if (has_bit(of_b.own_vertices, i)) vertex_of_b(of_a, of_b, i);
            if (!has_bit(of_a.own_sharp_edges, i)) continue;
            for (std::size_t j = 0; j < 3; ++j)
                if (has_bit(of_b.own_sharp_edges, j)) edges(i, j);
        }
        found_.least = std::sqrt(least_);
    }

  private:
    // In A's own frame.
    Vector3d point_in_a(const Vector3d& p) const noexcept { return pair_.X_BA.inverse() * p; }
    Vector3d direction_in_a(const Vector3d& d) const noexcept { return pair_.X_BA.linear().transpose() * d; }

    void vertex_of_a(const TriangleFeatures& of_a, const TriangleFeatures& of_b, std::size_t i) noexcept {
        const Vector3d& p = pair_.corners_a[i];
        const TrianglePoint foot = closest_point_on_triangle(p, pair_.corners_b);
        const Vector3d d = p - foot.point;
        if (is_far(foot.squared_distance) || !belongs_to(of_b, foot) ||
            !pair_.b.is_nearest_outside(pair_.triangle_b, foot, d) ||
            !pair_.a.is_nearest_at_vertex(of_a.vertices[i], direction_in_a(-d)))
            return;
        add(p, foot.point);
    }

    // A vertex on a vertex was A's.
    void vertex_of_b(const TriangleFeatures& of_a, const TriangleFeatures& of_b, std::size_t i) noexcept {
        const Vector3d& p = pair_.corners_b[i];
        TrianglePoint foot = closest_point_on_triangle(p, pair_.corners_a);
        const Vector3d on_a = foot.point, d = p - on_a;
        if (is_far(foot.squared_distance) || foot.feature == Feature::vertex || !belongs_to(of_a, foot) ||
            !pair_.b.is_nearest_at_vertex(of_b.vertices[i], -d))
            return;
        foot.point = point_in_a(on_a);
        if (pair_.a.is_nearest_outside(pair_.triangle_a, foot, direction_in_a(d))) add(on_a, p);
    }

    // Where an end is nearest it is a vertex' pair.
    void edges(std::size_t i, std::size_t j) noexcept {
        const auto near = closest_points_of_segments(pair_.corners_a[i], pair_.corners_a[(i + 1) % 3],
                                                     pair_.corners_b[j], pair_.corners_b[(j + 1) % 3]);
        if (is_far(near.squared_distance) || !(near.s > 0 && near.s < 1 && near.t > 0 && near.t < 1)) return;
        const Vector3d d = near.first - near.second;
        if (pair_.b.is_nearest_on_edge(pair_.triangle_b, j, near.second, d) &&
            pair_.a.is_nearest_on_edge(pair_.triangle_a, i, point_in_a(near.first), direction_in_a(-d)))
            add(near.first, near.second);
    }

    bool is_far(double squared_distance) noexcept {
        least_ = std::min(least_, squared_distance);
        return !(squared_distance > 0) || squared_distance > within_ * within_;
    }
    void add(const Vector3d& on_a, const Vector3d& on_b) noexcept {
        found_.minima[found_.count++] = {on_a, on_b, (on_a - on_b).norm()};
    }

    const FeaturePair& pair_;
    const double within_;
    PairMinima& found_;
    double least_ = std::numeric_limits<double>::infinity();  // mm²
};

}  // namespace

void local_minima(const FeaturePair& pair, double within, PairMinima& found) noexcept {
    Finder(pair, within, found).find();
}

}  // namespace palpate::collision
