// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/convex/closest_features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "runtime/collision/balls/ball_pairs.hpp"
#include "runtime/collision/convex/piece_steps.hpp"
#include "runtime/collision/segment_queries.hpp"

namespace palpate::collision {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int most_steps = 64;
constexpr double ahead = 0.2;        // mm, beyond `within`, up to which is searched
constexpr double rounding = 1e-10;   // mm, by which a vertex may be nearer
constexpr double no_nearer = 1e-12;  // of a squared distance: less is no step

// A pair of triangles and their nearest points.
struct Place {
    std::int32_t of_a, of_b;
    TrianglePair points;

    double squared() const noexcept { return points.on_a.squared_distance; }  // distance
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
        : a_(a), b_(b), X_BA_(X_BA), X_AB_(X_BA.inverse()), pair_(pair), best_(where_it_was()) {}

    // What is found, and a distance than which nothing is nearer.
    std::pair<Place, double> find(double within) noexcept {
        const bool was_found = pair_.on_a.kind != Feature::face || pair_.on_b.kind != Feature::face;
        if (was_found)
            if (const auto at_least = prove(within)) return {best_, *at_least};
        if (was_found) best_ = between(best_.of_a, best_.of_b);
        for (int step = 0; step < most_steps && (step_on_a(best_) || step_on_b(best_));) ++step;
        if (const auto at_least = prove(within)) return {best_, *at_least};
        search(within + ahead);
        return {best_, std::min(distance(), within + ahead)};
    }

  private:
    double distance() const noexcept { return std::sqrt(best_.squared()); }
    TriangleCorners corners_of_a(std::int32_t triangle) const noexcept {
        return placed(X_BA_, a_.features().corners(static_cast<std::size_t>(triangle)));
    }
    TriangleCorners corners_of_b(std::int32_t triangle) const noexcept {
        return b_.features().corners(static_cast<std::size_t>(triangle));
    }

    // The nearest points of the features that had them last; of two faces, which had none, of the triangles.
    Place where_it_was() const noexcept {
        const TriangleFeature &of_a = pair_.on_a, &of_b = pair_.on_b;
        const TriangleCorners a = corners_of_a(of_a.triangle), b = corners_of_b(of_b.triangle);
        Place place{of_a.triangle, of_b.triangle, {}};
        auto &on_a = place.points.on_a, &on_b = place.points.on_b;
        if (of_a.kind == Feature::vertex) {
            on_b = closest_point_on_triangle(a[of_a.which], b);
            on_a = corner(a, of_a.which);
        } else if (of_b.kind == Feature::vertex) {
            on_a = closest_point_on_triangle(b[of_b.which], a);
            on_b = corner(b, of_b.which);
        } else if (of_a.kind == Feature::edge && of_b.kind == Feature::edge) {
            const SegmentPair near = closest_points_of_segments(a[of_a.which], a[(of_a.which + 1U) % 3],
                                                                b[of_b.which], b[(of_b.which + 1U) % 3]);
            on_a = on_edge(of_a.which, near.s, near.first);
            on_b = on_edge(of_b.which, near.t, near.second);
        } else {
            return between(of_a.triangle, of_b.triangle);
        }
        on_a.squared_distance = on_b.squared_distance = (on_a.point - on_b.point).squaredNorm();
        return place;
    }
    static TrianglePoint corner(const TriangleCorners& of, std::size_t i) noexcept {
        return {of[i], Vector3d::Unit(static_cast<Eigen::Index>(i)), 0, Feature::vertex};
    }
    static TrianglePoint on_edge(std::size_t i, double s, const Vector3d& p) noexcept {
        TrianglePoint point{p, Vector3d::Zero(), 0, s > 0 && s < 1 ? Feature::edge : Feature::vertex};
        point.barycentric[static_cast<Eigen::Index>(i)] = 1 - s;
        point.barycentric[static_cast<Eigen::Index>((i + 1) % 3)] = s;
        return point;
    }

    Place between(std::int32_t of_a, std::int32_t of_b) const noexcept {
        return {of_a, of_b, closest_points_of_triangles(corners_of_a(of_a), corners_of_b(of_b))};
    }
    void take_if_nearer(const Place& place) noexcept {
        if (place.is_nearer_than(best_)) best_ = place;
    }

    // Ways from one point to the other, and points, each in the frame of its surface.
    Vector3d way_of_a(const Place& at) const noexcept {
        return X_AB_.linear() * (at.points.on_b.point - at.points.on_a.point);
    }
    Vector3d point_of_a(const Place& at) const noexcept { return X_AB_ * at.points.on_a.point; }
    static Vector3d way_of_b(const Place& at) noexcept { return at.points.on_a.point - at.points.on_b.point; }
    static const Vector3d& point_of_b(const Place& at) noexcept { return at.points.on_b.point; }

    // To a triangle of one piece beside the one that the point is on, if it is nearer.
    bool step_on_a(Place& at) const noexcept {
        const Vector3d way = way_of_a(at), from = point_of_a(at);
        return any_beyond(a_, at.of_a, at.points.on_a, [&](std::int32_t t) {
            return leads_on(a_, t, from, way) && step_to(between(t, at.of_b), at);
        });
    }
    bool step_on_b(Place& at) const noexcept {
        const Vector3d way = way_of_b(at), from = point_of_b(at);
        return any_beyond(b_, at.of_b, at.points.on_b, [&](std::int32_t t) {
            return leads_on(b_, t, from, way) && step_to(between(at.of_a, t), at);
        });
    }
    static bool step_to(const Place& there, Place& at) noexcept {
        if (!there.is_nearer_than(at)) return false;
        at = there;
        return true;
    }
    // Whether a corner of a triangle lies on along the way from a point.
    static bool leads_on(const ConvexPieces& of, std::int32_t triangle, const Vector3d& from,
                         const Vector3d& way) noexcept {
        const TriangleCorners corners = of.features().corners(static_cast<std::size_t>(triangle));
        return std::ranges::any_of(corners, [&](const Vector3d& p) { return way.dot(p - from) > 0; });
    }

    // A distance than which nothing is nearer, if it can be told: the planes through the two points, across
    // the way between them, part the pieces but for what stands out of them. Where that is not beyond
    // `within`, and one of the pieces lies all behind its plane, those triangles of the other are asked that
    // do not.
    std::optional<double> prove(double within) noexcept {
        if (!(best_.squared() > 0)) return 0;
        const double of_a = stands_out_of_a(best_), of_b = stands_out_of_b(best_);
        const double at_least = distance() - of_a - of_b;
        if (at_least > within) return at_least;
        const bool a_lies_behind = of_a <= rounding, b_lies_behind = of_b <= rounding;
        if (a_lies_behind && b_lies_behind) return distance();
        if (b_lies_behind) return ask_triangles_of_a(within + ahead);
        if (a_lies_behind) return ask_triangles_of_b(within + ahead);
        return std::nullopt;
    }
    // How far a vertex of a piece is before the plane through its point, mm.
    double stands_out_of_a(const Place& at) const noexcept {
        return stands_out(a_, pair_.piece_a, point_of_a(at), way_of_a(at));
    }
    double stands_out_of_b(const Place& at) const noexcept {
        return stands_out(b_, pair_.piece_b, point_of_b(at), way_of_b(at));
    }
    static double stands_out(const ConvexPieces& of, std::int32_t piece, const Vector3d& point,
                             const Vector3d& way) noexcept {
        double most = way.dot(point);
        const double plane = most;
        for (const PieceVertex& v : of.piece(piece).vertices)
            most = std::max(most, way.dot(of.features().vertex(v.vertex)));
        return (most - plane) / way.norm();
    }

    // Of A's, or B's, triangles asks those that may be nearer than the two points, and than `beyond`, and
    // takes what is nearer. Returns a distance than which none is nearer, if that can be told.
    std::optional<double> ask_triangles_of_a(double beyond) noexcept {
        const Vector3d unit = way_of_a(best_).normalized(), plane = X_AB_ * point_of_b(best_);
        const PieceNode& ball = b_.node(b_.piece(pair_.piece_b).root);
        const Vector3d centre = X_AB_ * centre_of(ball);
        double least_left = std::numeric_limits<double>::infinity();
        for (const std::int32_t t : a_.piece(pair_.piece_a).triangles) {
            const TriangleCorners corners = a_.features().corners(static_cast<std::size_t>(t));
            const double enough = std::min(distance(), beyond) - rounding;
            const double least = at_least(corners, plane, unit, centre, radius_of(ball), enough);
            if (least >= enough) {
                least_left = std::min(least_left, least);
                continue;
            }
            Place at = between(t, best_.of_b);
            for (int step = 0; step < most_steps && step_on_b(at);) ++step;
            take_if_nearer(at);
            if (at.squared() > 0 && stands_out_of_b(at) > rounding) return std::nullopt;
        }
        return std::min(distance(), least_left);
    }
    std::optional<double> ask_triangles_of_b(double beyond) noexcept {
        const Vector3d unit = way_of_b(best_).normalized(), plane = best_.points.on_a.point;
        const PieceNode& ball = a_.node(a_.piece(pair_.piece_a).root);
        const Vector3d centre = X_BA_ * centre_of(ball);
        double least_left = std::numeric_limits<double>::infinity();
        for (const std::int32_t t : b_.piece(pair_.piece_b).triangles) {
            const TriangleCorners corners = corners_of_b(t);
            const double enough = std::min(distance(), beyond) - rounding;
            const double least = at_least(corners, plane, unit, centre, radius_of(ball), enough);
            if (least >= enough) {
                least_left = std::min(least_left, least);
                continue;
            }
            Place at = between(best_.of_a, t);
            for (int step = 0; step < most_steps && step_on_a(at);) ++step;
            take_if_nearer(at);
            if (at.squared() > 0 && stands_out_of_a(at) > rounding) return std::nullopt;
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
    static Vector3d centre_of(const PieceNode& ball) noexcept {
        return {ball.centre[0], ball.centre[1], ball.centre[2]};
    }
    static double radius_of(const PieceNode& ball) noexcept { return static_cast<double>(ball.radius); }

    void search(double within) noexcept {
        if (!(best_.squared() > 0)) return;
        double least = std::min(distance(), within);
        const Vector3d unit = -way_of_b(best_).normalized();  // from A's point to B's
        for_each_pair(
            a_, b_, [&](const PieceNode& a, const PieceNode& b) { return may_be_near(a, X_BA_, b, least); },
            [&](const PieceNode& a, const PieceNode& b) {
                if (are_apart_along(unit, a.triangle, b.triangle, least)) return true;
                take_if_nearer(between(a.triangle, b.triangle));
                least = std::min(least, distance());
                return least > 0;
            },
            {a_.piece(pair_.piece_a).root, b_.piece(pair_.piece_b).root});
    }
    bool are_apart_along(const Vector3d& unit, std::int32_t of_a, std::int32_t of_b,
                         double least) const noexcept {
        const TriangleCorners a = corners_of_a(of_a), b = corners_of_b(of_b);
        const double last = std::max({unit.dot(a[0]), unit.dot(a[1]), unit.dot(a[2])}),
                     first = std::min({unit.dot(b[0]), unit.dot(b[1]), unit.dot(b[2])});
        return first - last >= least;
    }

    const ConvexPieces &a_, &b_;
    const Isometry3d& X_BA_;
    const Isometry3d X_AB_;
    const PiecePair pair_;
    Place best_;
};

}  // namespace

ClosestFeatures closest_features(const ConvexPieces& a, const Isometry3d& X_BA, const ConvexPieces& b,
                                 double within, PiecePair& pair) noexcept {
    const auto [found, at_least] = Walk(a, X_BA, b, pair).find(within);
    pair.on_a = feature_of(found.of_a, found.points.on_a);
    pair.on_b = feature_of(found.of_b, found.points.on_b);
    return {found.points, at_least};
}

}  // namespace palpate::collision
