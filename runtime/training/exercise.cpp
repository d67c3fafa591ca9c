// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/exercise.hpp"

#include <algorithm>
#include <limits>

namespace palpate::training {

using Eigen::Vector3d;

double length_of(const std::vector<Vector3d>& points) {
    double length = 0;
    for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
    return length;
}

Vector3d point_along(const std::vector<Vector3d>& points, double distance) {
    for (std::size_t i = 1; i < points.size(); ++i) {
        const Vector3d way = points[i] - points[i - 1];
        const double length = way.norm();
        if (length > 0 && distance <= length) return points[i - 1] + way * (distance / length);
        distance -= length;
    }
    return points.back();
}

LinePoint nearest_on_line(const std::vector<Vector3d>& points, const Vector3d& p, double from, double to) {
    LinePoint best{.along = from, .distance = std::numeric_limits<double>::max()};
    double along = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
        const Vector3d way = points[i] - points[i - 1];
        const double length = way.norm();
        const double least = std::max(0.0, from - along), most = std::min(length, to - along);
        if (length > 0 && least <= most) {
            const double at = std::clamp((p - points[i - 1]).dot(way) / length, least, most);
            const double distance = (points[i - 1] + way * (at / length) - p).norm();
            if (distance < best.distance) best = {.along = along + at, .distance = distance};
        }
        along += length;
    }
    return best;
}

Vector3d point_ahead(const std::vector<Vector3d>& points, const Vector3d& p, std::size_t due,
                     double distance) {
    const double here = nearest_on_line(points, p, 0, length_of(points)).along;
    const std::vector<Vector3d> until_due(points.begin(),
                                          points.begin() + static_cast<std::ptrdiff_t>(due) + 1);
    return point_along(points, here + std::clamp(length_of(until_due) - here, -distance, distance));
}

}  // namespace palpate::training
