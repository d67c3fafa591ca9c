// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/cones/cone_pairs.hpp"

#include <cmath>

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

Vector3d vector(const std::array<float, 3>& v) noexcept {
    return {v[0], v[1], v[2]};
}

// An angle between 0 and pi by its cosine and sine.
struct Angle {
    double cosine, sine;
};

Angle half_angle(const ConeNode& node) noexcept {
    return {static_cast<double>(node.cosine), static_cast<double>(node.sine)};
}

Angle operator+(const Angle& a, const Angle& b) noexcept {
    const double sine = a.sine * b.cosine + a.cosine * b.sine;
    if (a.cosine <= -1 || b.cosine <= -1 || sine < 0) return {-1, 0};  // pi or more
    return {a.cosine * b.cosine - a.sine * b.sine, sine};
}

// Whether a unit vector and another, of that length, have no larger angle between them.
bool is_within(const Vector3d& unit, const Vector3d& other, double length, const Angle& most) noexcept {
    constexpr double rounding = 1e-6;
    return unit.dot(other) >= (most.cosine - rounding) * length;
}

}  // namespace

bool may_be_nearest(const ConeNode& a, const Eigen::Isometry3d& X_BA, const ConeNode& b,
                    const ConeReach& reach) noexcept {
    const Vector3d way = X_BA * vector(a.centre) - vector(b.centre);
    const double apart = way.norm();
    const double radii = static_cast<double>(a.radius) + static_cast<double>(b.radius) + reach.slack +
                         reach.turn * static_cast<double>(a.arm);
    if (apart - radii > reach.within) return false;
    const Vector3d axis_a = X_BA.linear() * vector(a.axis), axis_b = vector(b.axis);
    const Angle of_a = half_angle(a) + Angle{reach.cosine, reach.sine}, of_b = half_angle(b);
    if (!is_within(axis_b, -axis_a, 1, of_a + of_b)) return false;
    if (!(apart > radii)) return true;
    // The way from a point of b to one of a goes along that of the centres up to so much.
    const double sine = radii / apart;
    const Angle spread{std::sqrt(1 - sine * sine), sine};
    return is_within(axis_b, way, apart, of_b + spread) && is_within(axis_a, -way, apart, of_a + spread);
}

}  // namespace palpate::collision
