// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/condensation/cluster_order.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace palpate::fem {

std::int32_t cluster_depth(std::int32_t node_count, std::int32_t largest_leaf) {
    std::int32_t depth = 0;
    while (((node_count - 1) >> depth) >= largest_leaf) ++depth;
    return depth;
}

std::vector<std::int32_t> cluster_order(std::span<const Eigen::Vector3d> points, std::int32_t depth) {
    std::vector<std::int32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    const auto begin = [&](std::int32_t level, std::int64_t cluster) {
        return order.begin() + ((static_cast<std::int64_t>(points.size()) * cluster) >> level);
    };
    for (std::int32_t level = 0; level < depth; ++level)
        for (std::int64_t cluster = 0; cluster < (std::int64_t{1} << level); ++cluster) {
            const auto first = begin(level, cluster), last = begin(level, cluster + 1);
            Eigen::AlignedBox3d box;
            for (auto at = first; at != last; ++at) box.extend(points[*at]);
            Eigen::Index axis = 0;
            box.sizes().maxCoeff(&axis);
            std::nth_element(first, begin(level + 1, 2 * cluster + 1), last,
                             [&](std::int32_t a, std::int32_t b) {
                                 const double x = points[a][axis], y = points[b][axis];
                                 return x < y || (x == y && a < b);
                             });
        }
    return order;
}

}  // namespace palpate::fem
