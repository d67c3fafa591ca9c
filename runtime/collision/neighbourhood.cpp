// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/neighbourhood.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>

namespace palpate {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
// Four floats in one register (GCC and Clang), and what comparing them gives.
using Float4 = float __attribute__((vector_size(16)));
using Mask4 = std::int32_t __attribute__((vector_size(16)));

// mm by which float32 may be off, a few millimetres from the centre; a twentieth of the god-object's skin.
constexpr float rounding = 5e-6F;
// The margin grows and shrinks until about so many triangles are gathered: fewer are gathered too often, more
// take longer to sift.
constexpr std::size_t few = 20, many = 72;
constexpr double least_margin = 0.02, most_margin = 8;  // mm
constexpr double growth = 1.25;
// A way of this many margins is a jump, not the motion of a tick.
constexpr double jump = 8;

Float4 load(const float* four) noexcept {
    Float4 value;
    std::memcpy(&value, four, sizeof(value));
    return value;
}

bool any(const Mask4& mask) noexcept {
    std::uint64_t halves[2];
    std::memcpy(halves, &mask, sizeof(halves));
    return (halves[0] | halves[1]) != 0;
}

}  // namespace

// How far a sphere about p may move and still have all it can touch gathered, mm.
double Neighbourhood::room(const Vector3d& p, double radius) const noexcept {
    return reach_ - radius - (p - centre_).norm();
}

void Neighbourhood::take(const CollisionSurface& surface, std::size_t at, std::int32_t slot) noexcept {
    const TriangleCorners t = surface.corners(slot);
    const Vector3d a = t[0] - centre_, b = t[1] - centre_, c = t[2] - centre_;
    const Vector3d middle = (a + b + c) / 3;
    const double ball = std::sqrt(
        std::max({(a - middle).squaredNorm(), (b - middle).squaredNorm(), (c - middle).squaredNorm()}));
    // A triangle of hardly any area has no plane that could hold anything off: all of space is on it.
    const Vector3d cross = (b - a).cross(c - a);
    const double twice_area = cross.norm();
    const bool flat = twice_area > 1e-4 * ball * ball;
    const Vector3d normal = flat ? Vector3d(cross / twice_area) : Vector3d::Zero();
    const auto as_float = [](double value) { return static_cast<float>(value); };
    x_[at] = as_float(middle[0]);
    y_[at] = as_float(middle[1]);
    z_[at] = as_float(middle[2]);
    ball_[at] = as_float(ball);
    nx_[at] = as_float(normal[0]);
    ny_[at] = as_float(normal[1]);
    nz_[at] = as_float(normal[2]);
    offset_[at] = as_float(normal.dot(middle));
    slots_[at] = slot;
}

// Gathers around `centre` what a sphere of `radius` that moves by `step` needs; false if that is too much.
bool Neighbourhood::gather(const CollisionSurface& surface, const Vector3d& centre, double radius,
                           double step) noexcept {
    centre_ = centre;
    for (int attempt = 0; attempt < 4; ++attempt) {
        reach_ = radius + std::max(margin_, 1.5 * step);
        count_ = 0;
        const std::size_t found = surface.slots_near(centre, centre, reach_, slots_);
        if (found == 0) {
            // In the open: as far as the nearest triangle there is nothing to gather.
            const auto nearest = surface.closest_point(centre, reach_ + most_margin);
            reach_ = nearest ? nearest->distance : reach_ + most_margin;
            return true;
        }
        if (found < few) margin_ = std::min(growth * margin_, most_margin);
        if (found > many) margin_ = std::max(margin_ / growth, least_margin);
        if (found > capacity) {
            margin_ = std::max(margin_ / 2, least_margin);
            continue;
        }
        for (; count_ < found; ++count_) take(surface, count_, slots_[count_]);
        // Lanes beyond the last triangle never seem near.
        for (std::size_t at = found; at % lanes != 0; ++at) {
            x_[at] = y_[at] = z_[at] = nx_[at] = ny_[at] = nz_[at] = offset_[at] = 0;
            ball_[at] = -1e6F;
        }
        return true;
    }
    reach_ = -1;
    return false;
}

std::optional<SweepContact> Neighbourhood::sweep_gathered(const CollisionSurface& surface,
                                                          const Vector3d& from, const Vector3d& way,
                                                          double radius, double limit) const noexcept {
    SweepContact best;
    best.fraction = limit;
    best.slot = -1;
    const Vector3f a = (from - centre_).cast<float>(), b = (from + limit * way - centre_).cast<float>();
    const Vector3f middle = 0.5F * (a + b);
    const float touching = static_cast<float>(radius) + rounding;
    const float half = 0.5F * (b - a).norm() + touching;
    for (std::size_t first = 0; first < count_; first += lanes) {
        const Float4 x = load(&x_[first]) - middle[0], y = load(&y_[first]) - middle[1],
                     z = load(&z_[first]) - middle[2];
        const Float4 near_by = load(&ball_[first]) + half;
        Mask4 candidates = (x * x + y * y + z * z <= near_by * near_by) & (near_by > 0);
        if (!any(candidates)) continue;
        // A sphere that begins and ends on the same side of a plane, clear of it, does not touch what lies in
        // it.
        const Float4 nx = load(&nx_[first]), ny = load(&ny_[first]), nz = load(&nz_[first]),
                     offset = load(&offset_[first]);
        const Float4 at_a = nx * a[0] + ny * a[1] + nz * a[2] - offset,
                     at_b = nx * b[0] + ny * b[1] + nz * b[2] - offset;
        candidates &= ~(((at_a > touching) & (at_b > touching)) | ((at_a < -touching) & (at_b < -touching)));
        if (!any(candidates)) continue;
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            if (!candidates[lane]) continue;
            const std::int32_t slot = slots_[first + lane];
            const auto contact =
                sweep_sphere_triangle(from, way, radius, best.fraction, surface.corners(slot));
            if (!contact || (best.slot >= 0 && contact->fraction >= best.fraction)) continue;
            best = {contact->fraction, contact->point, contact->normal, surface.mesh_triangle(slot), slot};
            if (best.fraction <= 0) return best;
        }
    }
    if (best.slot < 0) return std::nullopt;
    return best;
}

std::optional<SweepContact> Neighbourhood::sweep_sphere(const CollisionSurface& surface, const Vector3d& from,
                                                        const Vector3d& to, double radius) noexcept {
    const Vector3d way = to - from;
    const double length = way.norm();
    if (!(length > 0)) return std::nullopt;
    double step = room(from, radius);
    if (step < length && step < 0.25 * margin_) {
        // In contact the way leads far below the surface, and the sphere will not follow: one margin is
        // enough.
        if (length > jump * most_margin || !gather(surface, from, radius, std::min(length, margin_)))
            return surface.sweep_sphere(from, to, radius);
        step = room(from, radius);
    }
    const double limit = std::min(1.0, step / length);
    if (const auto contact = sweep_gathered(surface, from, way, radius, limit)) return contact;
    return limit < 1 ? surface.sweep_sphere(from, to, radius) : std::nullopt;
}

}  // namespace palpate
