// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/points/farthest_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::collision {
namespace {

using Eigen::Vector3f;

constexpr std::int32_t leaf_size = 8;
constexpr float least_cosine = -0.5F;  // of two normals whose points can be near

}  // namespace

FarthestPoints::FarthestPoints(const std::vector<ShellPoint>& candidates) {
    candidates_.reserve(candidates.size());
    for (const ShellPoint& point : candidates)
        candidates_.push_back({point, std::numeric_limits<float>::infinity()});
    nodes_.reserve(candidates.size() / 2);
    build(0, static_cast<std::int32_t>(candidates_.size()));
}

void FarthestPoints::build(std::int32_t begin, std::int32_t end) {
    const std::size_t node = nodes_.size();
    const auto first = candidates_.begin() + begin, last = candidates_.begin() + end;
    Vector3f low = first->point.position, high = low;
    std::for_each(first, last, [&](const Candidate& candidate) {
        low = low.cwiseMin(candidate.point.position);
        high = high.cwiseMax(candidate.point.position);
    });
    nodes_.push_back({low, high, std::numeric_limits<float>::infinity(), begin, end, 0});
    if (end - begin <= leaf_size) return;
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const std::int32_t middle = begin + (end - begin) / 2;
    std::nth_element(first, candidates_.begin() + middle, last, [&](const Candidate& a, const Candidate& b) {
        return a.point.position[axis] < b.point.position[axis];
    });
    build(begin, middle);
    nodes_[node].second_child = static_cast<std::int32_t>(nodes_.size());
    build(middle, end);
}

void FarthestPoints::lower(std::size_t index, const ShellPoint& point) {
    Node& node = nodes_[index];
    const Vector3f inside = point.position.cwiseMax(node.low).cwiseMin(node.high);
    if ((inside - point.position).squaredNorm() >= node.farthest) return;
    if (node.second_child > 0) {
        const auto second = static_cast<std::size_t>(node.second_child);
        lower(index + 1, point);
        lower(second, point);
        node.farthest = std::max(nodes_[index + 1].farthest, nodes_[second].farthest);
        return;
    }
    node.farthest = 0;
    for (std::int32_t i = node.begin; i < node.end; ++i) {
        Candidate& candidate = candidates_[static_cast<std::size_t>(i)];
        if (candidate.point.normal.dot(point.normal) >= least_cosine)
            candidate.squared_distance = std::min(candidate.squared_distance,
                                                  (candidate.point.position - point.position).squaredNorm());
        node.farthest = std::max(node.farthest, candidate.squared_distance);
    }
}

const ShellPoint& FarthestPoints::farthest() const {
    std::size_t at = 0;
    while (nodes_[at].second_child > 0)
        at = nodes_[at + 1].farthest == nodes_[at].farthest
                 ? at + 1
                 : static_cast<std::size_t>(nodes_[at].second_child);
    return std::max_element(
               candidates_.begin() + nodes_[at].begin, candidates_.begin() + nodes_[at].end,
               [](const Candidate& a, const Candidate& b) { return a.squared_distance < b.squared_distance; })
        ->point;
}

double FarthestPoints::covering_radius() const {
    return std::sqrt(static_cast<double>(nodes_.front().farthest));
}

}  // namespace palpate::collision
