// SPDX-License-Identifier: Apache-2.0
// How a hierarchy of normal cones is built.
#include "runtime/collision/cones/normal_cone_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "formats/model/errors.hpp"

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

// What float32 and sums of unit normals may be off by, upwards: mm, of a radius, and rad.
constexpr double place_rounding = 1e-4, radius_rounding = 1e-6, angle_rounding = 1e-4;

double angle_between(const Vector3d& a, const Vector3d& b) {
    return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

class Builder {
  public:
    Builder(const SurfaceFeatures& features, std::vector<ConeNode>& nodes)
        : features_(features), nodes_(nodes), order_(features.triangle_count()) {
        std::iota(order_.begin(), order_.end(), 0);
        for (std::size_t t = 0; t < order_.size(); ++t) {
            const TriangleCorners corners = features.corners(t);
            normals_.push_back(unit_normal(corners));
            centroids_.push_back((corners[0] + corners[1] + corners[2]) / 3);
        }
        spread_to_features();
        nodes_.reserve(2 * order_.size());
        nodes_.emplace_back();
    }

    void split(std::size_t index, std::span<std::int32_t> part) {
        set_ball(nodes_[index], part);
        set_cone(nodes_[index], part);
        if (part.size() == 1) {
            nodes_[index].triangle = part.front();
            return;
        }
        const std::size_t half = part.size() / 2;
        const Eigen::Index axis = longest_axis(part);
        std::ranges::nth_element(
            part, part.begin() + static_cast<std::ptrdiff_t>(half), {},
            [&](std::int32_t t) { return std::pair(centroids_[static_cast<std::size_t>(t)][axis], t); });
        const std::size_t left = nodes_.size();
        nodes_[index].left = static_cast<std::int32_t>(left);
        nodes_.emplace_back();
        nodes_.emplace_back();
        split(left, part.first(half));
        split(left + 1, part.subspan(half));
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

    Eigen::Index longest_axis(std::span<const std::int32_t> part) const {
        Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
        for (const std::int32_t t : part) {
            low = low.cwiseMin(centroids_[static_cast<std::size_t>(t)]);
            high = high.cwiseMax(centroids_[static_cast<std::size_t>(t)]);
        }
        Eigen::Index axis = 0;
        (high - low).maxCoeff(&axis);
        return axis;
    }

    void set_ball(ConeNode& node, std::span<const std::int32_t> part) const {
        Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
        for (const std::int32_t t : part)
            for (const Vector3d& corner : features_.corners(static_cast<std::size_t>(t))) {
                low = low.cwiseMin(corner);
                high = high.cwiseMax(corner);
            }
        const Vector3d centre = (low + high) / 2;
        double radius = 0;
        for (const std::int32_t t : part)
            for (const Vector3d& corner : features_.corners(static_cast<std::size_t>(t)))
                radius = std::max(radius, (corner - centre).norm());
        Eigen::Map<Eigen::Vector3f>(node.centre.data()) = centre.cast<float>();
        node.radius = static_cast<float>(radius * (1 + radius_rounding) + place_rounding);
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
    std::vector<Vector3d> normals_, centroids_;
    std::vector<double> spreads_;
    std::vector<std::vector<std::int32_t>> rings_;
};

}  // namespace

NormalConeTree::NormalConeTree(const SurfaceFeatures& features) : features_(features) {
    if (features.triangle_count() == 0)
        throw InvalidInput({"normal cones", "a surface without triangles", "one at least", ""});
    Builder builder(features, nodes_);
    builder.split(0, builder.all());
    for (std::size_t t = 0; t < features.triangle_count(); ++t)
        for (const Vector3d& corner : features.corners(t))
            longest_arm_ = std::max(longest_arm_, corner.norm());
}

}  // namespace palpate::collision
