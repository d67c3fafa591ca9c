// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/convex/closest_features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "runtime/collision/balls/ball_pairs.hpp"
#include "runtime/collision/convex/placed_piece.hpp"
#include "runtime/collision/segment_queries.hpp"

namespace palpate::collision {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int most_steps = 64;
constexpr double ahead = 0.2;        // mm, beyond `within`, up to which is searched
constexpr double rounding = 1e-10;   // mm, by which a vertex may be nearer
constexpr double no_nearer = 1e-12;  // of a squared distance: less is no step

// A pair of triangles, of A and of B, and their nearest points.
struct Place {
    std::array<std::int32_t, 2> triangles;
    TrianglePair points;

    double squared() const noexcept { return points.on_a.squared_distance; }  // distance
    const TrianglePoint& on(std::size_t side) const noexcept { return side == 0 ? points.on_a : points.on_b; }
    bool is_nearer_than(const Place& other) const noexcept {
        return squared() < (1 - no_nearer) * other.squared();
    }
};

TriangleFeature feature_of(std::int32_t triangle, const TrianglePoint& point) noexcept {
    if (point.feature == Feature::face) return {triangle, Feature::face, 0};
    const std::size_t which = point.feature == Feature::vertex ? corner_of(point) : edge_of(point);
    return {triangle, point.feature, static_cast<std::uint8_t>(which)};
}

class Walk {
  public:
    Walk(const ConvexPieces& a, const Isometry3d& X_BA, const ConvexPieces& b, const PiecePair& pair) noexcept
        : sides_(placed_pieces(a, X_BA, b, pair)),
          best_(where_it_was(pair.on_a, pair.on_b)),
          was_found_(pair.on_a.kind != Feature::face || pair.on_b.kind != Feature::face) {}

    // What is found, and a distance than which nothing is nearer.
    std::pair<Place, double> find(double within) noexcept {
        if (was_found_) {
            if (const auto at_least = prove(within)) return {best_, *at_least};
            best_ = between(best_.triangles);
        }
        for (int step = 0; step < most_steps && (step_on(0, best_) || step_on(1, best_));) ++step;
        if (const auto at_least = prove(within)) return {best_, *at_least};
        search(within + ahead);
        return {best_, std::min(distance(), within + ahead)};
    }

  private:
    double distance() const noexcept { return std::sqrt(best_.squared()); }

    // The nearest points of the features that had them last; of two faces, which had none, of the triangles.
    Place where_it_was(const TriangleFeature& of_a, const TriangleFeature& of_b) const noexcept {
        const TriangleCorners a = sides_[0].corners(of_a.triangle), b = sides_[1].corners(of_b.triangle);
        Place place{{of_a.triangle, of_b.triangle}, {}};
        auto &on_a = place.points.on_a, &on_b = place.points.on_b;
        if (of_a.kind == Feature::vertex) {
            on_b = closest_point_on_triangle(a[of_a.which], b);
            on_a = corner_point(a, of_a.which);
        } else if (of_b.kind == Feature::vertex) {
            on_a = closest_point_on_triangle(b[of_b.which], a);
            on_b = corner_point(b, of_b.which);
        } else if (of_a.kind == Feature::edge && of_b.kind == Feature::edge) {
            const SegmentPair near = closest_points_of_segments(a[of_a.which], a[(of_a.which + 1U) % 3],
                                                                b[of_b.which], b[(of_b.which + 1U) % 3]);
            on_a = edge_point(of_a.which, near.s, near.first);
            on_b = edge_point(of_b.which, near.t, near.second);
        } else {
            return between(place.triangles);
        }
        on_a.squared_distance = on_b.squared_distance = (on_a.point - on_b.point).squaredNorm();
        place.points.normal = (on_b.point - on_a.point).normalized();
        return place;
    }

    Place between(const std::array<std::int32_t, 2>& triangles) const noexcept {
        return {triangles, closest_points_of_triangles(sides_[0].corners(triangles[0]),
                                                       sides_[1].corners(triangles[1]))};
    }
    // The same with another triangle on one side.
    Place between(const Place& at, std::size_t side, std::int32_t triangle) const noexcept {
        std::array<std::int32_t, 2> triangles = at.triangles;
        triangles[side] = triangle;
        return between(triangles);
    }
    void take_if_nearer(const Place& place) noexcept {
        if (place.is_nearer_than(best_)) best_ = place;
    }

    // The way from a side's point to the other's, and the point, in the side's own frame.
    Vector3d way(std::size_t side, const Place& at) const noexcept {
        return sides_[side].X_own.linear() * (at.on(1 - side).point - at.on(side).point);
    }
    Vector3d point(std::size_t side, const Place& at) const noexcept {
        return sides_[side].X_own * at.on(side).point;
    }

    // To a triangle of one piece beside the one that the point is on, if it is nearer.
    bool step_on(std::size_t side, Place& at) const noexcept {
        const PlacedPiece& of = sides_[side];
        const Vector3d on = way(side, at), from = point(side, at);
        const Place start = at;
        return any_beyond(of.surface, start.triangles[side], start.on(side), [&](std::int32_t t) {
            const auto leads_on = [&](const Vector3d& p) { return on.dot(p - from) > 0; };
            if (std::ranges::none_of(of.own_corners(t), leads_on)) return false;
            const Place there = between(start, side, t);
            if (!there.is_nearer_than(start)) return false;
            at = there;
            return true;
        });
    }

    // A distance than which nothing is nearer, if it can be told: the planes through the two points, across
    // the way between them, part the pieces but for what stands out of them. Where that is not beyond
    // `within`, and one of the pieces lies all behind its plane, those triangles of the other are asked that
    // do not.
    std::optional<double> prove(double within) noexcept {
        if (!(best_.squared() > 0)) return 0;
        const std::array<double, 2> out{stands_out(0, best_), stands_out(1, best_)};
        const double at_least = distance() - out[0] - out[1];
        if (at_least > within) return at_least;
        const std::array<bool, 2> is_behind{out[0] <= rounding, out[1] <= rounding};
        if (is_behind[0] && is_behind[1]) return distance();
        if (!is_behind[0] && !is_behind[1]) return std::nullopt;
        return ask_triangles(is_behind[0] ? 1 : 0, within + ahead);
    }
    // How far a vertex of a piece is before the plane through its point, mm.
    double stands_out(std::size_t side, const Place& at) const noexcept {
        const PlacedPiece& of = sides_[side];
        const Vector3d on = way(side, at);
        const double plane = on.dot(point(side, at));
        double most = plane;
        for (const PieceVertex& v : of.surface.piece(of.piece).vertices)
            most = std::max(most, on.dot(of.surface.features().vertex(v.vertex)));
        return (most - plane) / on.norm();
    }

    // Of a side's triangles asks those that may be nearer than the two points, and than `beyond`, and takes
    // what is nearer. Returns a distance than which none is nearer, if that can be told.
    std::optional<double> ask_triangles(std::size_t side, double beyond) noexcept {
        const PlacedPiece &of = sides_[side], &other = sides_[1 - side];
        const Vector3d unit = way(side, best_).normalized(), plane = of.X_own * best_.on(1 - side).point;
        const PieceNode& ball = other.ball();
        const Vector3d centre =
            of.X_own * (other.X_B * Vector3d(ball.centre[0], ball.centre[1], ball.centre[2]));
        double least_left = std::numeric_limits<double>::infinity();
        for (const std::int32_t t : of.surface.piece(of.piece).triangles) {
            const double enough = std::min(distance(), beyond) - rounding;
            const double least =
                at_least(of.own_corners(t), plane, unit, centre, static_cast<double>(ball.radius), enough);
            if (least >= enough) {
                least_left = std::min(least_left, least);
                continue;
            }
            Place at = between(best_, side, t);
            for (int step = 0; step < most_steps && step_on(1 - side, at);) ++step;
            take_if_nearer(at);
            if (at.squared() > 0 && stands_out(1 - side, at) > rounding) return std::nullopt;
        }
        return std::min(distance(), least_left);
    }
    // How far a triangle is at least from what lies behind a plane through `plane`, to which `unit` leads,
    // or, where that is less than `enough`, and in a ball.
    static double at_least(const TriangleCorners& corners, const Vector3d& plane, const Vector3d& unit,
                           const Vector3d& centre, double radius, double enough) noexcept {
        const double above = std::min(
            {unit.dot(plane - corners[0]), unit.dot(plane - corners[1]), unit.dot(plane - corners[2])});
        if (above >= enough) return above;
        return std::max(above,
                        std::sqrt(closest_point_on_triangle(centre, corners).squared_distance) - radius);
    }

    void search(double within) noexcept {
        double least = std::min(distance(), within);
        const Vector3d unit = way(1, best_).normalized();  // from B's point to A's
        const auto& [a, b] = sides_;
        for_each_pair(
            a.surface, b.surface,
            [&](const PieceNode& of_a, const PieceNode& of_b) {
                return may_be_near(of_a, a.X_B, of_b, least);
            },
            [&](const PieceNode& of_a, const PieceNode& of_b) {
                if (are_apart_along(unit, a.corners(of_a.triangle), b.corners(of_b.triangle), least))
                    return true;
                take_if_nearer(between({of_a.triangle, of_b.triangle}));
                least = std::min(least, distance());
                return least > 0;
            },
            {a.surface.piece(a.piece).root, b.surface.piece(b.piece).root});
    }
    static bool are_apart_along(const Vector3d& unit, const TriangleCorners& a, const TriangleCorners& b,
                                double least) noexcept {
        const double first = std::min({unit.dot(a[0]), unit.dot(a[1]), unit.dot(a[2])}),
                     last = std::max({unit.dot(b[0]), unit.dot(b[1]), unit.dot(b[2])});
        return first - last >= least;
    }

    const std::array<PlacedPiece, 2> sides_;  // A and B
    Place best_;
    const bool was_found_;
};

}  // namespace

ClosestFeatures closest_features(const ConvexPieces& a, const Isometry3d& X_BA, const ConvexPieces& b,
                                 double within, PiecePair& pair) noexcept {
    const auto [found, at_least] = Walk(a, X_BA, b, pair).find(within);
    pair.on_a = feature_of(found.triangles[0], found.points.on_a);
    pair.on_b = feature_of(found.triangles[1], found.points.on_b);
    return {found.points, at_least};
}

}  // namespace palpate::collision
