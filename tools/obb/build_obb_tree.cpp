// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/obb/build_obb_tree.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <string>

#include "formats/model/errors.hpp"

namespace palpate::obb {
namespace {

// A triangle as a uniform plate: its integrals of 1, x and x xᵀ.
struct Plate {
    double area;
    Eigen::Vector3d centroid;
    Eigen::Matrix3d second_moment;
};

void check(const TriangleMesh& surface, const ObbTreeOptions& options) {
    if (options.max_leaf_triangles < 1 || options.max_leaf_triangles > most_leaf_triangles)
        throw InvalidInput({"OBB tree", std::to_string(options.max_leaf_triangles) + " triangles per leaf",
                            "1 or more", ""});
    if (surface.triangles.empty())
        throw InvalidInput({"OBB tree", "the surface has no triangles", "at least 1", "check the surface"});
    for (std::size_t v = 0; v < surface.vertices.size(); ++v)
        if (!surface.vertices[v].allFinite())
            throw InvalidInput({"OBB tree", "vertex " + std::to_string(v) + " is not finite", "", ""});
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        for (const std::int32_t v : surface.triangles[t])
            if (v < 0 || static_cast<std::size_t>(v) >= surface.vertices.size())
                throw InvalidInput({"OBB tree",
                                    "triangle " + std::to_string(t) + " names vertex " + std::to_string(v),
                                    "0 ... " + std::to_string(surface.vertices.size()) + " - 1", ""});
}

class Builder {
  public:
    Builder(const TriangleMesh& surface, const ObbTreeOptions& options)
        : surface_(surface), max_leaf_(static_cast<std::size_t>(options.max_leaf_triangles)) {
        plates_.reserve(surface.triangles.size());
        for (const Triangle& triangle : surface.triangles) plates_.push_back(plate_of(triangle));
        tree_.triangle_order.resize(surface.triangles.size());
        std::iota(tree_.triangle_order.begin(), tree_.triangle_order.end(), 0);
    }

    ObbTree build() {
        struct Task {
            std::size_t node, begin, end;
        };
        tree_.nodes.resize(1);
        std::vector<Task> tasks{{0, 0, tree_.triangle_order.size()}};
        while (!tasks.empty()) {
            const Task task = tasks.back();
            tasks.pop_back();
            const std::span part = std::span(tree_.triangle_order).subspan(task.begin, task.end - task.begin);
            ObbNode node = fitted_box(part);
            if (part.size() <= max_leaf_) {
                node.first = static_cast<std::int32_t>(task.begin);
                node.count = static_cast<std::int32_t>(part.size());
                tree_.nodes[task.node] = node;
                continue;
            }
            const std::size_t left = tree_.nodes.size();
            const std::size_t middle = task.begin + split(part, node);
            node.first = static_cast<std::int32_t>(left);
            tree_.nodes[task.node] = node;
            tree_.nodes.resize(left + 2);
            tasks.push_back({left + 1, middle, task.end});
            tasks.push_back({left, task.begin, middle});
        }
        return std::move(tree_);
    }

  private:
    const Eigen::Vector3d& corner(std::int32_t triangle, std::size_t c) const {
        return surface_.vertices[surface_.triangles[triangle][c]];
    }

    Plate plate_of(const Triangle& triangle) const {
        const auto point = [&](std::size_t c) -> const Eigen::Vector3d& {
            return surface_.vertices[triangle[c]];
        };
        Plate plate;
        plate.area = 0.5 * (point(1) - point(0)).cross(point(2) - point(0)).norm();
        plate.centroid = (point(0) + point(1) + point(2)) / 3;
        plate.second_moment = 9 * plate.centroid * plate.centroid.transpose();
        for (std::size_t c = 0; c < 3; ++c) plate.second_moment += point(c) * point(c).transpose();
        plate.second_moment *= plate.area / 12;
        return plate;
    }

    // Rows: the principal axes of the triangles, a right-handed frame.
    Eigen::Matrix3d principal_axes(std::span<const std::int32_t> part) const {
        double area = 0;
        Eigen::Vector3d first = Eigen::Vector3d::Zero();
        Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
        for (const std::int32_t t : part) {
            const Plate& plate = plates_[t];
            area += plate.area;
            first += plate.area * plate.centroid;
            second += plate.second_moment;
        }
        if (!(area > 0)) return Eigen::Matrix3d::Identity();
        const Eigen::Vector3d mean = first / area;
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(second / area - mean * mean.transpose());
        Eigen::Matrix3d axes = solver.eigenvectors().transpose();
        axes.row(2) = axes.row(0).cross(axes.row(1));
        return axes;
    }

    // Extents are taken along the rounded axes from the rounded centre, so rounding cannot open the box.
    ObbNode fitted_box(std::span<const std::int32_t> part) const {
        ObbNode node;
        node.axes = principal_axes(part).cast<float>();
        const Eigen::Matrix3d axes = node.axes.cast<double>();
        Eigen::AlignedBox3d box;
        for (const std::int32_t t : part)
            for (std::size_t c = 0; c < 3; ++c) box.extend(axes * corner(t, c));
        node.center = (axes.transpose() * box.center()).cast<float>();
        const Eigen::Vector3d center = axes * node.center.cast<double>();
        const Eigen::Vector3d half_extents = (box.max() - center).cwiseMax(center - box.min());
        // A corner rounded to float32, less the centre, times a row: each step is off by half an ulp of a
        // number no larger than this reach; eight ulps cover them all.
        const double reach = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).sum();
        const double padding = 8 * static_cast<double>(std::numeric_limits<float>::epsilon()) * reach;
        node.half_extents = (half_extents.array() + padding).cast<float>();
        return node;
    }

    // The axis of the longest side along which the centroids differ at all.
    Eigen::Vector3d splitting_direction(std::span<const std::int32_t> part, const ObbNode& box) const {
        Eigen::AlignedBox3d centroids;
        const Eigen::Matrix3d axes = box.axes.cast<double>();
        for (const std::int32_t t : part) centroids.extend(axes * plates_[t].centroid);
        Eigen::Index longest = 0;
        (centroids.sizes().array() > 0).select(box.half_extents.cast<double>(), -1.0).maxCoeff(&longest);
        return axes.row(longest);
    }

    // Partitions `part` in two and returns the size of the first half, which is neither 0 nor all.
    std::size_t split(std::span<std::int32_t> part, const ObbNode& box) const {
        const Eigen::Vector3d direction = splitting_direction(part, box);
        const auto position = [&](std::int32_t t) { return direction.dot(plates_[t].centroid); };
        double mean = 0;
        for (const std::int32_t t : part) mean += position(t);
        mean /= static_cast<double>(part.size());
        const auto middle =
            std::partition(part.begin(), part.end(), [&](std::int32_t t) { return position(t) < mean; });
        const auto left = static_cast<std::size_t>(middle - part.begin());
        if (10 * std::min(left, part.size() - left) >= part.size()) return left;
        // Ties are broken by triangle number, so this also parts triangles with one common centroid.
        const auto median = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
        std::ranges::nth_element(part, median, {}, [&](std::int32_t t) { return std::pair(position(t), t); });
        return part.size() / 2;
    }

    const TriangleMesh& surface_;
    std::size_t max_leaf_;
    std::vector<Plate> plates_;
    ObbTree tree_;
};

}  // namespace

ObbTree build_obb_tree(const TriangleMesh& surface, const ObbTreeOptions& options) {
    check(surface, options);
    return Builder(surface, options).build();
}

}  // namespace palpate::obb
