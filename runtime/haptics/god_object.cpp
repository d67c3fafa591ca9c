// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/god_object.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double at_rest = 1e-7;       // mm: shorter moves are none
constexpr double settled = 0.01;       // mm: after a shorter round the next tick goes on (5 mN at 0.5 N/mm)
constexpr int max_sweeps = 15;         // per tick; smooth places take 3
constexpr double same_normal = 0.999;  // cosine; feet closer than 2.5 degrees are one

}  // namespace

bool GodObject::move(const CollisionSurface& surface, const Vector3d& device) noexcept {
    plane_count_ = 0;
    touch_count_ = 0;
    if (!following_) {
        position_ = last_device_ = device;
        if (surface.closest_point(device, radius_ + skin) || !surface.is_outside(device)) return false;
        following_ = true;
        return true;
    }
    slide(surface, device);
    last_device_ = device;
    if ((position_ - device).norm() > at_rest) find_touches(surface, device);
    return true;
}

// One round goes towards the device until nothing is in the way within the half-spaces touched in that round.
// The half-spaces are those of the first touches, so a sphere that slid off an edge hangs above the surface;
// further rounds let it down, until a round hardly moves it.
void GodObject::slide(const CollisionSurface& surface, const Vector3d& device) noexcept {
    double slide_left = 2 * (device - last_device_).norm() + slide_slack;
    int sweeps = 0;
    while (sweeps < max_sweeps) {
        const Vector3d round_start = position_;
        plane_count_ = 0;
        bool blocked = true;
        while (blocked && sweeps < max_sweeps) {
            Vector3d way = nearest_admissible(device) - position_;
            const double length = way.norm();
            const bool sliding = plane_count_ > 0;
            if (length <= at_rest || (sliding && slide_left <= at_rest)) break;
            if (sliding && length > slide_left) way *= slide_left / length;
            const Vector3d start = position_;
            const auto contact = surface.sweep_sphere(position_, position_ + way, radius_, hint_);
            ++sweeps;
            blocked = contact.has_value();
            if (blocked)
                touch(*contact, way);
            else
                position_ += way;
            if (sliding) slide_left -= (position_ - start).norm();
        }
        if (plane_count_ == 0 || (position_ - round_start).norm() <= settled) return;
    }
}

// Goes up to `contact`, keeping the skin clear, and adds its half-space.
void GodObject::touch(const SweepContact& contact, const Vector3d& way) noexcept {
    const double approach = -way.dot(contact.normal);
    // Where the way only grazes, backing off until the skin is clear would undo all of it; ten skins of way
    // do.
    const double longest = 10 * skin / way.norm();
    const double back_off = approach > 0 ? std::min(skin / approach, longest) : longest;
    position_ += std::max(0.0, contact.fraction - back_off) * way;
    hint_ = contact.slot;

    HalfSpace plane;
    plane.normal = contact.normal;
    plane.slot = contact.slot;
    // The centre itself stays admissible, so there is always a place to be.
    plane.offset =
        std::min(contact.normal.dot(contact.point) + radius_ + skin, contact.normal.dot(position_));
    planes_[plane_count_++] = plane;
}

// Minimises |x - device|² over the half-spaces by trying every set of up to three active ones for the
// conditions of Karush, Kuhn and Tucker: x = device + sum lambda_i n_i, n_i . x = b_i, lambda_i >= 0, all
// others admissible. The half-spaces that are not active are forgotten, which leaves room for the next touch.
Vector3d GodObject::nearest_admissible(const Vector3d& device) noexcept {
    const double tolerance = 1e-9;  // mm
    for (unsigned set = 0; set < 1U << plane_count_; ++set) {
        std::array<HalfSpace, max_touches> active;
        Eigen::Index count = 0;
        for (std::size_t i = 0; i < plane_count_; ++i)
            if (set >> i & 1U) active[static_cast<std::size_t>(count++)] = planes_[i];
        if (count > 3) continue;

        Vector3d x = device;
        if (count > 0) {
            Eigen::Matrix<double, 3, 3> normals = Eigen::Matrix3d::Zero();
            Eigen::Matrix3d gram = Eigen::Matrix3d::Identity();
            Vector3d lack = Vector3d::Zero();
            for (Eigen::Index i = 0; i < count; ++i) {
                normals.col(i) = active[static_cast<std::size_t>(i)].normal;
                lack[i] = active[static_cast<std::size_t>(i)].offset - normals.col(i).dot(device);
            }
            gram.topLeftCorner(count, count) = (normals.transpose() * normals).topLeftCorner(count, count);
            if (gram.determinant() < 1e-9) continue;  // nearly parallel: a smaller set does
            const Vector3d lambda = gram.inverse() * lack;
            if (lambda.minCoeff() < 0) continue;
            x += normals * lambda;
        }
        bool admissible = true;
        for (std::size_t i = 0; i < plane_count_; ++i)
            admissible = admissible && planes_[i].normal.dot(x) >= planes_[i].offset - tolerance;
        if (!admissible) continue;
        std::copy_n(active.begin(), count, planes_.begin());
        plane_count_ = static_cast<std::size_t>(count);
        return x;
    }
    plane_count_ = std::min(plane_count_, max_touches - 1);
    return position_;
}

void GodObject::find_touches(const CollisionSurface& surface, const Vector3d& device) noexcept {
    const auto add = [&](const ClosestPoint& foot) {
        if (!(foot.distance > 0)) return;
        const Vector3d normal = (position_ - foot.point) / foot.distance;
        for (std::size_t i = 0; i < touch_count_; ++i)
            if (touches_[i].normal.dot(normal) > same_normal) return;
        touches_[touch_count_++] = {foot, normal};
    };
    const double reach = radius_ + (position_ - device).norm();
    const auto nearest = surface.closest_point(position_, reach, hint_);
    if (!nearest) return;
    hint_ = nearest->slot;
    add(*nearest);
    // What holds the sphere in a groove or a corner beside the nearest point.
    for (std::size_t i = 0; i < plane_count_ && touch_count_ < max_touches; ++i) {
        const std::int32_t slot = planes_[i].slot;
        const TrianglePoint here = closest_point_on_triangle(position_, surface.corners(slot));
        const double distance = std::sqrt(here.squared_distance);
        if (distance > radius_ + 20 * skin) continue;
        add({here.point, here.barycentric, distance, surface.mesh_triangle(slot), slot, here.feature});
    }
}

}  // namespace palpate
