// SPDX-License-Identifier: Apache-2.0
// How a hierarchy of normal cones is built.
#include "runtime/collision/cones/normal_cone_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "formats/model/errors.hpp"

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

constexpr double angle_rounding = 1e-4;  // rad: what float32 and sums of unit normals may be off by, upwards

double angle_between(const Vector3d& a, const Vector3d& b) {
    return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

class Builder {
  public:
    Builder(const SurfaceFeatures& features, std::vector<ConeNode>& nodes)
        : features_(features),
          nodes_(nodes),
          order_(features.triangle_count()),
          centroids_(centroids_of(features)) {
        std::iota(order_.begin(), order_.end(), 0);
        for (std::size_t t = 0; t < order_.size(); ++t) normals_.push_back(unit_normal(features.corners(t)));
        spread_to_features();
        nodes_.reserve(2 * order_.size());
        nodes_.emplace_back();
    }

    void split(std::size_t index, std::span<std::int32_t> part) {
        static_cast<BallNode&>(nodes_[index]) = ball_about(features_, part);
        set_cone(nodes_[index], part);
        if (part.size() == 1) {
            nodes_[index].triangle = part.front();
            return;
        }
        const auto [first, second] = halve(part, centroids_);
        const std::size_t left = nodes_.size();
        nodes_[index].left = static_cast<std::int32_t>(left);
        nodes_.emplace_back();
        nodes_.emplace_back();
        split(left, first);
        split(left + 1, second);
    }

    std::span<std::int32_t> all() { return order_; }

  private:
    // How far the directions of what belongs to each triangle are from its normal, rad: up to the normals of
    // all triangles about its vertices and of those beyond its sharp edges; pi at a border.
    void spread_to_features() {
        gather_rings();
        for (const std::int32_t t : order_) {
            const TriangleFeatures& its = features_.of(static_cast<std::size_t>(t));
            double spread = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                const std::int32_t from = its.vertices[i], to = its.vertices[(i + 1) % 3];
                const bool vertex = has_bit(its.own_vertices, i), edge = has_bit(its.own_sharp_edges, i);
                if (edge && its.across[i] < 0) spread = std::numbers::pi;
                for (const std::int32_t other : rings_[static_cast<std::size_t>(from)])
                    if (vertex || (edge && has_vertex(other, to)))
                        spread = std::max(spread, spread_between(t, other, vertex));
            }
            spreads_.push_back(spread);
        }
    }

    double spread_between(std::int32_t t, std::int32_t other, bool at_vertex) const {
        const auto o = static_cast<std::size_t>(other);
        const bool open = normals_[o].isZero(0) ||
                          (at_vertex && std::ranges::any_of(features_.of(o).across,
                                                            [](std::int32_t across) { return across < 0; }));
        return open ? std::numbers::pi : angle_between(normals_[static_cast<std::size_t>(t)], normals_[o]);
    }

    bool has_vertex(std::int32_t triangle, std::int32_t vertex) const {
        return std::ranges::count(features_.of(static_cast<std::size_t>(triangle)).vertices, vertex) > 0;
    }

    // Of each vertex the triangles that share it.
    void gather_rings() {
        std::int32_t vertices = 0;
        for (const std::int32_t t : order_)
            for (const std::int32_t v : features_.of(static_cast<std::size_t>(t)).vertices)
                vertices = std::max(vertices, v + 1);
        rings_.resize(static_cast<std::size_t>(vertices));
        for (const std::int32_t t : order_)
            for (const std::int32_t v : features_.of(static_cast<std::size_t>(t)).vertices)
                rings_[static_cast<std::size_t>(v)].push_back(t);
    }

    void set_cone(ConeNode& node, std::span<const std::int32_t> part) const {
        Vector3d axis = Vector3d::Zero();
        for (const std::int32_t t : part) axis += normals_[static_cast<std::size_t>(t)];
        double half_angle = std::numbers::pi;
        if (axis.norm() > 0) {
            axis.normalize();
            half_angle = 0;
            for (const std::int32_t t : part) {
                const auto i = static_cast<std::size_t>(t);
                half_angle = std::max(half_angle, angle_between(axis, normals_[i]) + spreads_[i]);
            }
            Eigen::Map<Eigen::Vector3f>(node.axis.data()) = axis.cast<float>();
        }
        // A wider cone is none that holds the directions between its own.
        if (half_angle + angle_rounding >= std::numbers::pi / 2) return;
        node.cosine = static_cast<float>(std::cos(half_angle + angle_rounding));
        node.sine = static_cast<float>(std::sin(half_angle + angle_rounding));
    }

    const SurfaceFeatures& features_;
    std::vector<ConeNode>& nodes_;
    std::vector<std::int32_t> order_;
    std::vector<Vector3d> centroids_, normals_;
    std::vector<double> spreads_;
    std::vector<std::vector<std::int32_t>> rings_;
};

}  // namespace

NormalConeTree::NormalConeTree(const SurfaceFeatures& features) : features_(features) {
    if (features.triangle_count() == 0)
        throw InvalidInput({"normal cones", "a surface without triangles", "one at least", ""});
    Builder builder(features, nodes_);
    builder.split(0, builder.all());
    longest_arm_ = longest_arm_of(features);
}

}  // namespace palpate::collision
