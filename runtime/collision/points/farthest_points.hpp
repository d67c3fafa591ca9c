// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/collision/points/point_shell.hpp"

namespace palpate::collision {

/// The points of a surface that a shell is chosen from, each with its distance to the chosen: a binary tree
/// of boxes over them, halved at the median of the longest axis, that knows the farthest below each node.
class FarthestPoints {
  public:
    /// At least one candidate. O(n log n).
    explicit FarthestPoints(const std::vector<ShellPoint>& candidates);

    /// Chooses a point. Looks at the candidates that are nearer to it than to those chosen before, and their
    /// neighbours.
    void choose(const ShellPoint& point) { lower(0, point); }
    /// The candidate farthest from the chosen.
    const ShellPoint& farthest() const;
    /// Its distance, mm; infinite if no chosen point's normal is within 120 degrees of its own.
    double covering_radius() const;

  private:
    struct Candidate {
        ShellPoint point;
        float squared_distance;  // to the nearest chosen point, mm²
    };
    struct Node {
        Eigen::Vector3f low, high;
        float farthest;             // the largest squared distance below it
        std::int32_t begin, end;    // candidates
        std::int32_t second_child;  // the first is the next node; 0 for a leaf
    };

    void build(std::int32_t begin, std::int32_t end);
    void lower(std::size_t node, const ShellPoint& point);

    std::vector<Candidate> candidates_;
    std::vector<Node> nodes_;
};

}  // namespace palpate::collision
