// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/god_object.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace palpate::haptics {
namespace {

using namespace collision;
using Eigen::Vector3d;

constexpr double tiny = 1e-7;          // mm: shorter moves are none
constexpr double settled = 0.01;       // mm: after a shorter round the next tick goes on (5 mN at 0.5 N/mm)
constexpr int max_sweeps = 15;         // per tick; smooth places take 3
constexpr int most_slips = 8;          // past what is in a way; more are not looked behind
constexpr double parallel = 1e-9;      // determinant of normals' products: a smaller set does
constexpr double same_normal = 0.999;  // cosine; feet closer than 2.5 degrees are one

}  // namespace

void GodObject::reset() noexcept {
    for (Obstacle& obstacle : obstacles_) {
        obstacle.followed = false;
        obstacle.near.clear();
    }
    all_followed_ = any_followed_ = false;
    at_rest_ = true;
    clear_within_ = 0;
}

void GodObject::start_clear_at(const Vector3d& position) noexcept {
    reset();
    for (Obstacle& obstacle : obstacles_) obstacle.followed = true;
    all_followed_ = any_followed_ = !obstacles_.empty();
    position_ = last_device_ = position;
}

void GodObject::start_at(const GodObject& other) noexcept {
    // What is known of the neighbourhood holds wherever it is.
    let_go();
    for (std::size_t i = 0; i < obstacles_.size(); ++i) obstacles_[i].followed = other.obstacles_[i].followed;
    all_followed_ = other.all_followed_;
    any_followed_ = other.any_followed_;
    clear_about_ = other.clear_about_;
    clear_within_ = other.clear_within_;
    position_ = last_device_ = other.position_;
    held_back_.setZero();
    touches_ = other.touches_;
    touch_count_ = other.touch_count_;
}

// What touches next does so at rest, and as if nothing had been touched before.
void GodObject::let_go() noexcept {
    at_rest_ = true;
    for (Obstacle& obstacle : obstacles_) obstacle.near.let_go();
}

bool GodObject::move(Surfaces surfaces, const Vector3d& device, const Friction& friction) noexcept {
    plane_count_ = 0;
    touch_count_ = 0;
    held_back_.setZero();
    if (all_followed_ && is_known_clear() && is_known_clear_at(device)) {
        position_ = last_device_ = device;
        let_go();
        return true;
    }
    if (any_followed_)
        slide(surfaces, device, friction);
    else
        position_ = device;
    last_device_ = device;
    if (plane_count_ > 0 && (position_ - device).norm() > tiny)
        find_touches(surfaces, device);
    else
        let_go();
    for (std::size_t i = 0; i < obstacles_.size(); ++i)
        if (obstacles_[i].followed) obstacles_[i].near.look_ahead(*surfaces[i], position_, radius_);
    return all_followed_ || follow_what_is_clear(surfaces);
}

bool GodObject::follow_what_is_clear(Surfaces surfaces) noexcept {
    all_followed_ = true;
    for (std::size_t i = 0; i < obstacles_.size(); ++i) {
        Obstacle& obstacle = obstacles_[i];
        if (!obstacle.followed)
            obstacle.followed =
                !surfaces[i]->closest_point(position_, radius_ + skin) && surfaces[i]->is_outside(position_);
        any_followed_ = any_followed_ || obstacle.followed;
        all_followed_ = all_followed_ && obstacle.followed;
    }
    return all_followed_;
}

std::optional<GodObject::Hit> GodObject::sweep(Surfaces surfaces, const Vector3d& from,
                                               const Vector3d& to) noexcept {
    std::optional<Hit> first;
    for (std::size_t i = 0; i < obstacles_.size(); ++i) {
        if (!obstacles_[i].followed) continue;
        const auto contact = obstacles_[i].near.sweep_sphere(*surfaces[i], from, to, radius_);
        if (contact && !(first && first->contact.fraction <= contact->fraction)) first = {*contact, i};
    }
    return first;
}

std::optional<GodObject::Touch> GodObject::touch_on_the_way(Surfaces surfaces, const Vector3d& to,
                                                            double slight) noexcept {
    if (is_known_clear() && is_known_clear_at(to)) return std::nullopt;
    Vector3d from = position_, aside = Vector3d::Zero();
    for (int slip = 0;; ++slip) {
        const auto hit = sweep(surfaces, from, to + aside);
        if (!hit) return std::nullopt;
        const SweepContact& contact = hit->contact;
        if (contact.normal.dot(contact.point - to) + radius_ > slight) {
            const TrianglePoint foot =
                closest_point_on_triangle(contact.point, surfaces[hit->surface]->corners(contact.slot));
            return Touch{
                {contact.point, foot.barycentric, radius_, contact.triangle, contact.slot, foot.feature},
                contact.normal,
                hit->surface};
        }
        if (slip == most_slips) return std::nullopt;
        const Vector3d more = (skin + std::max(0.0, slight)) * contact.normal;
        from += contact.fraction * (to + aside - from) + more;
        aside += more;
    }
}

void GodObject::settle_at(Surfaces surfaces, const Vector3d& to) noexcept {
    if (position_ != to && !touch_on_the_way(surfaces, to)) position_ = to;
}

// One round goes towards the device until nothing is in the way within the half-spaces touched in that round.
// The half-spaces are those of the first touches, so a sphere that slid off an edge hangs above the surface;
// further rounds let it down, until a round hardly moves it.
void GodObject::slide(Surfaces surfaces, const Vector3d& device, const Friction& friction) noexcept {
    double slide_left = 2 * (device - last_device_).norm() + slide_slack;
    int sweeps = 0;
    while (sweeps < max_sweeps) {
        const Vector3d round_start = position_;
        plane_count_ = 0;
        held_back_.setZero();
        bool blocked = true;
        while (blocked && sweeps < max_sweeps) {
            const Vector3d wanted = nearest_admissible(device);
            const bool sliding = plane_count_ > 0;
            const bool held = sliding && friction.at_rest > 0;
            Vector3d goal = held ? held_by(friction, device, wanted) : wanted;
            Vector3d way = goal - position_;
            if (held) held_back_ = wanted - position_;
            const double length = way.norm();
            if (length <= tiny || (sliding && slide_left <= tiny)) break;
            if (sliding && length > slide_left) {
                way *= slide_left / length;
                goal = position_ + way;
            }
            const Vector3d start = position_;
            const auto hit = sweep(surfaces, position_, goal);
            ++sweeps;
            blocked = hit.has_value();
            if (blocked)
                touch(*hit, way);
            else
                position_ = goal;
            if (sliding) slide_left -= (position_ - start).norm();
            if (held) held_back_ = wanted - position_;
        }
        if (plane_count_ == 0 || (position_ - round_start).norm() <= settled) return;
    }
}

// Goes up to the touched point, keeping the skin clear, and adds its half-space.
void GodObject::touch(const Hit& hit, const Vector3d& way) noexcept {
    const SweepContact& contact = hit.contact;
    const double approach = -way.dot(contact.normal);
    // Where the way only grazes, backing off until the skin is clear would undo all of it; ten skins of way
    // do.
    const double longest = 10 * skin / way.norm();
    const double back_off = approach > 0 ? std::min(skin / approach, longest) : longest;
    position_ += std::max(0.0, contact.fraction - back_off) * way;

    HalfSpace plane;
    plane.normal = contact.normal;
    plane.slot = contact.slot;
    plane.surface = hit.surface;
    // The centre itself stays admissible, so there is always a place to be.
    plane.offset =
        std::min(contact.normal.dot(contact.point) + radius_ + skin, contact.normal.dot(position_));
    planes_[plane_count_++] = plane;
}

// The spring from the sphere to the device presses with its part along wanted - device and drags with its
// part along wanted - position: where the drag is more than friction holds, the sphere follows until it is
// not.
Vector3d GodObject::held_by(const Friction& friction, const Vector3d& device,
                            const Vector3d& wanted) noexcept {
    const Vector3d way = wanted - position_;
    const double drag = way.norm(), press = (wanted - device).norm();
    // What has just slid up to the sliding coefficient goes on sliding.
    if (drag <= (at_rest_ ? friction.at_rest * press : friction.sliding * press - tiny)) {
        at_rest_ = true;
        return position_;
    }
    at_rest_ = false;
    return wanted - friction.sliding * press / drag * way;
}

// Minimises |x - device|² over the half-spaces by trying every set of up to three active ones for the
// conditions of Karush, Kuhn and Tucker: x = device + sum lambda_i n_i, n_i . x = b_i, lambda_i >= 0, all
// others admissible. The half-spaces that are not active are forgotten, which leaves room for the next touch.
Vector3d GodObject::nearest_admissible(const Vector3d& device) noexcept {
    if (plane_count_ == 0) return device;
    if (plane_count_ == 1) {
        const double lack = planes_[0].offset - planes_[0].normal.dot(device);
        if (lack <= 0) {
            plane_count_ = 0;
            return device;
        }
        return device + lack * planes_[0].normal;
    }
    const double tolerance = 1e-9;  // mm
    std::array<double, max_touches> lacks;
    for (std::size_t i = 0; i < plane_count_; ++i)
        lacks[i] = planes_[i].offset - planes_[i].normal.dot(device);
    for (unsigned set = 0; set < 1U << plane_count_; ++set) {
        std::array<std::size_t, max_touches> active{};
        std::size_t count = 0;
        for (std::size_t i = 0; i < plane_count_; ++i)
            if (set >> i & 1U) active[count++] = i;
        if (count > 3) continue;
        const auto normal = [&](std::size_t k) -> const Vector3d& { return planes_[active[k]].normal; };

        Vector3d x = device;
        if (count == 1) {
            const double lambda = 1 / normal(0).dot(normal(0)) * lacks[active[0]];
            if (lambda < 0) continue;
            x += normal(0) * lambda;
        } else if (count == 2) {
            const double a = normal(0).dot(normal(0)), b = normal(0).dot(normal(1)),
                         d = normal(1).dot(normal(1)), determinant = a * d - b * b;
            if (determinant < parallel) continue;
            const double inverse = 1 / determinant, first = lacks[active[0]], second = lacks[active[1]];
            const double lambda = d * inverse * first - b * inverse * second,
                         mu = a * inverse * second - b * inverse * first;
            if (lambda < 0 || mu < 0) continue;
            x += normal(0) * lambda + normal(1) * mu;
        } else if (count == 3) {
            Eigen::Matrix3d normals;
            normals << normal(0), normal(1), normal(2);
            const Eigen::Matrix3d gram = normals.transpose() * normals;
            if (gram.determinant() < parallel) continue;
            const Vector3d lambda =
                gram.inverse() * Vector3d(lacks[active[0]], lacks[active[1]], lacks[active[2]]);
            if (lambda.minCoeff() < 0) continue;
            x += normals * lambda;
        }
        bool admissible = true;
        for (std::size_t i = 0; i < plane_count_; ++i)
            admissible = admissible && planes_[i].normal.dot(x) >= planes_[i].offset - tolerance;
        if (!admissible) continue;
        for (std::size_t k = 0; k < count; ++k)
            if (active[k] != k) planes_[k] = planes_[active[k]];
        plane_count_ = count;
        return x;
    }
    plane_count_ = std::min(plane_count_, max_touches - 1);
    return position_;
}

// The feet are on the triangles whose half-spaces hold the sphere.
void GodObject::find_touches(Surfaces surfaces, const Vector3d& device) noexcept {
    const auto add = [&](const ClosestPoint& foot, std::size_t surface) {
        if (!(foot.distance > 0)) return;
        const Vector3d normal = (position_ - foot.point) / foot.distance;
        for (std::size_t i = 0; i < touch_count_; ++i)
            if (touches_[i].normal.dot(normal) > same_normal) return;
        touches_[touch_count_++] = {foot, normal, surface};
    };
    for (std::size_t i = 0; i < plane_count_ && touch_count_ < max_touches; ++i) {
        const auto& [normal, offset, slot, surface] = planes_[i];
        const TrianglePoint here = closest_point_on_triangle(position_, surfaces[surface]->corners(slot));
        const double distance = std::sqrt(here.squared_distance);
        if (distance > radius_ + 2 * settled) continue;
        add({here.point, here.barycentric, distance, surfaces[surface]->mesh_triangle(slot), slot,
             here.feature},
            surface);
    }
    if (touch_count_ == 0) {
        const std::size_t surface = planes_[0].surface;
        const double reach = radius_ + (position_ - device).norm();
        if (const auto nearest = surfaces[surface]->closest_point(position_, reach, planes_[0].slot))
            add(*nearest, surface);
    }
    const auto end = touches_.begin() + static_cast<std::ptrdiff_t>(touch_count_);
    std::ranges::sort(touches_.begin(), end, {}, [](const Touch& touch) { return touch.foot.distance; });
}

}  // namespace palpate::haptics
