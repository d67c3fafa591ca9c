// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/convex/closest_features.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/collision/balls/ball_pairs.hpp"
#include "runtime/collision/convex/piece_steps.hpp"

namespace palpate::collision {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int most_steps = 64;
constexpr double rounding = 1e-10;   // mm, by which a vertex may be nearer
constexpr double no_nearer = 1e-12;  // of a squared distance: less is no step

class Walk {
  public:
    Walk(const ConvexPieces& a, const Isometry3d& X_BA, const ConvexPieces& b, PiecePair& pair) noexcept
        : a_(a), b_(b), X_BA_(X_BA), X_AB_(X_BA.inverse()), pair_(pair) {}

    TrianglePair find(double within) noexcept {
        found_ = between(pair_.triangle_a, pair_.triangle_b);
        for (int step = 0; step < most_steps && apart() > 0 && (step_on_a() || step_on_b());) ++step;
        if (apart() > 0 && !is_least()) search(within);
        return found_;
    }

  private:
    double apart() const noexcept { return found_.on_a.squared_distance; }

    TrianglePair between(std::int32_t of_a, std::int32_t of_b) const noexcept {
        return closest_points_of_triangles(
            placed(X_BA_, a_.features().corners(static_cast<std::size_t>(of_a))),
            b_.features().corners(static_cast<std::size_t>(of_b)));
    }

    bool improves(std::int32_t of_a, std::int32_t of_b) noexcept {
        const TrianglePair pair = between(of_a, of_b);
        if (!(pair.on_a.squared_distance < (1 - no_nearer) * apart())) return false;
        found_ = pair;
        pair_.triangle_a = of_a;
        pair_.triangle_b = of_b;
        return true;
    }

    // From A's point to B's, in A's frame, and A's point there.
    Vector3d way_in_a() const noexcept { return X_AB_.linear() * (found_.on_b.point - found_.on_a.point); }
    Vector3d point_in_a() const noexcept { return X_AB_ * found_.on_a.point; }

    bool step_on_a() noexcept {
        const Vector3d way = way_in_a(), from = point_in_a();
        return any_beyond(a_, pair_.triangle_a, found_.on_a, [&](std::int32_t t) {
            return leads_on(a_, t, from, way) && improves(t, pair_.triangle_b);
        });
    }
    bool step_on_b() noexcept {
        const Vector3d way = found_.on_a.point - found_.on_b.point, from = found_.on_b.point;
        return any_beyond(b_, pair_.triangle_b, found_.on_b, [&](std::int32_t t) {
            return leads_on(b_, t, from, way) && improves(pair_.triangle_a, t);
        });
    }

    // Whether a corner of a triangle lies on along the way from a point.
    static bool leads_on(const ConvexPieces& of, std::int32_t triangle, const Vector3d& from,
                         const Vector3d& way) noexcept {
        const TriangleCorners corners = of.features().corners(static_cast<std::size_t>(triangle));
        return std::ranges::any_of(corners, [&](const Vector3d& p) { return way.dot(p - from) > 0; });
    }

    // Whether all of both pieces lies beyond the planes through the two points, across the way between them:
    // then nothing of their hulls is nearer.
    bool is_least() const noexcept {
        const double distance = std::sqrt(apart());
        return lies_behind(a_, pair_.piece_a, point_in_a(), way_in_a() / distance) &&
               lies_behind(b_, pair_.piece_b, found_.on_b.point,
                           (found_.on_a.point - found_.on_b.point) / distance);
    }
    static bool lies_behind(const ConvexPieces& of, std::int32_t piece, const Vector3d& point,
                            const Vector3d& way) noexcept {
        const double most = way.dot(point) + rounding;
        return std::ranges::all_of(of.piece(piece).vertices, [&](const PieceVertex& v) {
            return way.dot(of.features().vertex(v.vertex)) <= most;
        });
    }

    void search(double within) noexcept {
        double least = std::min(std::sqrt(apart()), within);
        for_each_pair(
            a_, b_, [&](const PieceNode& a, const PieceNode& b) { return may_be_near(a, X_BA_, b, least); },
            [&](const PieceNode& a, const PieceNode& b) {
                if (improves(a.triangle, b.triangle)) least = std::min(least, std::sqrt(apart()));
                return apart() > 0;
            },
            {a_.piece(pair_.piece_a).root, b_.piece(pair_.piece_b).root});
    }

    const ConvexPieces &a_, &b_;
    const Isometry3d& X_BA_;
    const Isometry3d X_AB_;
    PiecePair& pair_;
    TrianglePair found_;
};

}  // namespace

TrianglePair closest_features(const ConvexPieces& a, const Isometry3d& X_BA, const ConvexPieces& b,
                              double within, PiecePair& pair) noexcept {
    return Walk(a, X_BA, b, pair).find(within);
}

}  // namespace palpate::collision
