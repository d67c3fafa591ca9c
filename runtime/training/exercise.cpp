// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/exercise.hpp"

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

}  // namespace palpate::training
