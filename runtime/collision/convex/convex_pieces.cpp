// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/convex/convex_pieces.hpp"

#include <algorithm>
#include <numeric>

#include "formats/model/errors.hpp"

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

struct Plane {
    Vector3d normal;
    double offset;
    double before(const Vector3d& p) const { return normal.dot(p) - offset; }  // mm
};

// Of each vertex whether triangles of three different normals meet in it, or it is at a border.
std::vector<bool> pointed_vertices(const SurfaceFeatures& features) {
    constexpr double same = 1 - 5e-9;  // cosine of 1e-4 rad
    std::int32_t last = -1;
    for (std::size_t t = 0; t < features.triangle_count(); ++t)
        last = std::max(last, std::ranges::max(features.of(t).vertices));
    struct Met {
        Vector3d first{0, 0, 0}, second{0, 0, 0};
    };
    std::vector<Met> met(static_cast<std::size_t>(last + 1));
    std::vector<bool> pointed(met.size());
    for (std::size_t t = 0; t < features.triangle_count(); ++t) {
        const Vector3d normal = unit_normal(features.corners(t));
        const TriangleFeatures& of = features.of(t);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto v = static_cast<std::size_t>(of.vertices[i]);
            if (of.beyond[i] < 0)
                pointed[v] = pointed[static_cast<std::size_t>(of.vertices[(i + 1) % 3])] = true;
            if (normal.isZero(0)) continue;
            if (met[v].first.isZero(0) || met[v].first.dot(normal) > same)
                met[v].first = normal;
            else if (met[v].second.isZero(0) || met[v].second.dot(normal) > same)
                met[v].second = normal;
            else
                pointed[v] = true;
        }
    }
    return pointed;
}

// Grows one piece after the other.
class Growth {
  public:
    explicit Growth(const SurfaceFeatures& features)
        : features_(features),
          piece_of_(features.triangle_count(), -1),
          pointed_(pointed_vertices(features)) {}

    // The piece from `seed` on, in the order in which its triangles joined it.
    void grow(std::int32_t seed, std::int32_t piece) {
        triangles.clear();
        vertices.clear();
        planes_.clear();
        join(seed, piece);
        for (std::size_t next = 0; next < triangles.size(); ++next)
            for (const std::int32_t beyond : of(triangles[next]).beyond)
                if (beyond >= 0 && piece_of_[static_cast<std::size_t>(beyond)] < 0 &&
                    triangles.size() < ConvexPieces::most_triangles && keeps_convex(beyond))
                    join(beyond, piece);
    }

    std::vector<std::int32_t> triangles;
    std::vector<PieceVertex> vertices;
    const std::vector<std::int32_t>& piece_of() const { return piece_of_; }

  private:
    const TriangleFeatures& of(std::int32_t t) const { return features_.of(static_cast<std::size_t>(t)); }
    Plane plane_of(std::int32_t t) const {
        const TriangleCorners corners = features_.corners(static_cast<std::size_t>(t));
        const Vector3d normal = unit_normal(corners);
        return {normal, normal.dot(corners[0])};
    }
    bool is_new(std::int32_t vertex) const {
        return std::ranges::find(vertices, vertex, &PieceVertex::vertex) == vertices.end();
    }

    bool keeps_convex(std::int32_t t) const {
        const Plane plane = plane_of(t);
        if (plane.normal.isZero(0) || planes_.front().normal.isZero(0)) return false;
        const auto is_behind = [&](const Plane& of, std::int32_t v) {
            return of.before(features_.vertex(v)) <= ConvexPieces::flat_within;
        };
        if (!std::ranges::all_of(vertices, [&](const PieceVertex& v) { return is_behind(plane, v.vertex); }))
            return false;
        return std::ranges::all_of(of(t).vertices, [&](std::int32_t v) {
            return !is_new(v) ||
                   std::ranges::all_of(planes_, [&](const Plane& each) { return is_behind(each, v); });
        });
    }

    void join(std::int32_t t, std::int32_t piece) {
        piece_of_[static_cast<std::size_t>(t)] = piece;
        triangles.push_back(t);
        planes_.push_back(plane_of(t));
        for (std::int16_t corner = 0; corner < 3; ++corner) {
            const std::int32_t v = of(t).vertices[static_cast<std::size_t>(corner)];
            if (is_new(v)) vertices.push_back({v, t, corner, pointed_[static_cast<std::size_t>(v)]});
        }
    }

    const SurfaceFeatures& features_;
    std::vector<std::int32_t> piece_of_;
    std::vector<bool> pointed_;  // vertices
    std::vector<Plane> planes_;  // of the piece's triangles
};

// The tree of balls: over pieces down to one, then over its triangles.
class BallTree {
  public:
    BallTree(const SurfaceFeatures& features, const ConvexPieces& pieces, std::vector<PieceNode>& nodes,
             std::vector<std::int32_t>& roots)
        : features_(features),
          pieces_(pieces),
          nodes_(nodes),
          roots_(roots),
          centroids_(centroids_of(features)) {
        for (std::size_t p = 0; p < pieces.count(); ++p) {
            const std::span<const std::int32_t> triangles = triangles_of(static_cast<std::int32_t>(p));
            Vector3d sum = Vector3d::Zero();
            for (const std::int32_t t : triangles) sum += centroids_[static_cast<std::size_t>(t)];
            places_.emplace_back(sum / static_cast<double>(triangles.size()));
        }
        nodes.reserve(2 * features.triangle_count());
        nodes.emplace_back();
    }

    void split_pieces(std::size_t index, std::span<std::int32_t> pieces) {
        if (pieces.size() == 1) {
            roots_[static_cast<std::size_t>(pieces.front())] = static_cast<std::int32_t>(index);
            const auto triangles = triangles_of(pieces.front());
            std::vector<std::int32_t> order(triangles.begin(), triangles.end());
            split_triangles(index, order, pieces.front());
            return;
        }
        all_.clear();
        for (const std::int32_t p : pieces) {
            const auto triangles = triangles_of(p);
            all_.insert(all_.end(), triangles.begin(), triangles.end());
        }
        static_cast<BallNode&>(nodes_[index]) = ball_about(features_, all_);
        const auto [first, second] = halve(pieces, places_);
        const std::size_t left = add_children(index);
        split_pieces(left, first);
        split_pieces(left + 1, second);
    }

  private:
    std::span<const std::int32_t> triangles_of(std::int32_t piece) const {
        return pieces_.piece(piece).triangles;
    }

    void split_triangles(std::size_t index, std::span<std::int32_t> triangles, std::int32_t piece) {
        static_cast<BallNode&>(nodes_[index]) = ball_about(features_, triangles);
        nodes_[index].piece = piece;
        if (triangles.size() == 1) {
            nodes_[index].triangle = triangles.front();
            return;
        }
        const auto [first, second] = halve(triangles, centroids_);
        const std::size_t left = add_children(index);
        split_triangles(left, first, piece);
        split_triangles(left + 1, second, piece);
    }

    std::size_t add_children(std::size_t index) {
        const std::size_t left = nodes_.size();
        nodes_[index].left = static_cast<std::int32_t>(left);
        nodes_.emplace_back();
        nodes_.emplace_back();
        return left;
    }

    const SurfaceFeatures& features_;
    const ConvexPieces& pieces_;
    std::vector<PieceNode>& nodes_;
    std::vector<std::int32_t>& roots_;
    std::vector<Vector3d> centroids_, places_;  // of triangles, of pieces
    std::vector<std::int32_t> all_;
};

}  // namespace

ConvexPieces::ConvexPieces(const SurfaceFeatures& features)
    : features_(features), triangle_begin_{0}, vertex_begin_{0} {
    if (features.triangle_count() == 0)
        throw InvalidInput({"convex pieces", "a surface without triangles", "one at least", ""});
    Growth growth(features);
    for (std::size_t t = 0; t < features.triangle_count(); ++t) {
        if (growth.piece_of()[t] >= 0) continue;
        growth.grow(static_cast<std::int32_t>(t), static_cast<std::int32_t>(triangle_begin_.size()) - 1);
        triangles_.insert(triangles_.end(), growth.triangles.begin(), growth.triangles.end());
        vertices_.insert(vertices_.end(), growth.vertices.begin(), growth.vertices.end());
        triangle_begin_.push_back(static_cast<std::int32_t>(triangles_.size()));
        vertex_begin_.push_back(static_cast<std::int32_t>(vertices_.size()));
    }
    piece_of_ = growth.piece_of();
    roots_.resize(triangle_begin_.size() - 1);
    BallTree tree(features, *this, nodes_, roots_);
    std::vector<std::int32_t> order(count());
    std::iota(order.begin(), order.end(), 0);
    tree.split_pieces(0, order);
    longest_arm_ = longest_arm_of(features);
}

}  // namespace palpate::collision
