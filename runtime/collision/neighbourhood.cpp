// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/neighbourhood.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>

namespace palpate::collision {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
// Four floats in one register (GCC and Clang), and what comparing them gives.
using Float4 = float __attribute__((vector_size(16)));
using Mask4 = std::int32_t __attribute__((vector_size(16)));

// mm by which float32 may be off, a few millimetres from the centre; a fifth of the god-object's skin.
constexpr float rounding = 2e-5F;
// The margin grows and shrinks until about so many triangles are gathered: fewer are gathered too often, more
// take longer to sift.
constexpr std::size_t few = 20, many = 72;
constexpr double least_margin = 0.02, most_margin = 8;  // mm
constexpr double growth = 1.25;
constexpr double first_piece = 0.02;  // mm
constexpr int most_pieces = 4;
// float32's error in a squared distance, relative.
constexpr float widening = 1 + 1e-5F;
// A way of this many margins is a jump, not the motion of a tick.
constexpr double jump = 8;

Float4 load(const float* four) noexcept {
    Float4 value;
    std::memcpy(&value, four, sizeof(value));
    return value;
}

Float4 root(const Float4& value) noexcept {
    Float4 result;
    for (int lane = 0; lane < 4; ++lane) result[lane] = std::sqrt(value[lane]);
    return result;
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

namespace {

// The smallest circle around a triangle, in its plane: about the circumcentre, or the longest edge's middle
// where the triangle is obtuse.
struct Circle {
    Vector3f centre;
    float radius;
};

Circle smallest_circle(const Vector3f& a, const Vector3f& b, const Vector3f& c) noexcept {
    const float aa = (b - c).squaredNorm(), bb = (c - a).squaredNorm(), cc = (a - b).squaredNorm();
    const float at_a = bb + cc - aa, at_b = cc + aa - bb, at_c = aa + bb - cc;
    if (at_a > 0 && at_b > 0 && at_c > 0) {
        const float wa = aa * at_a, wb = bb * at_b, wc = cc * at_c;
        const Vector3f centre = (wa * a + wb * b + wc * c) / (wa + wb + wc);
        return {centre, std::sqrt(std::max({(a - centre).squaredNorm(), (b - centre).squaredNorm(),
                                            (c - centre).squaredNorm()}))};
    }
    if (aa >= bb && aa >= cc) return {0.5F * (b + c), 0.5F * std::sqrt(aa)};
    return bb >= cc ? Circle{0.5F * (c + a), 0.5F * std::sqrt(bb)}
                    : Circle{0.5F * (a + b), 0.5F * std::sqrt(cc)};
}

}  // namespace

void Neighbourhood::take(const CollisionSurface& surface, std::size_t at, std::int32_t slot) noexcept {
    const TriangleCorners t = surface.corners(slot);
    const Vector3f a = (t[0] - centre_).cast<float>(), b = (t[1] - centre_).cast<float>(),
                   c = (t[2] - centre_).cast<float>();
    const auto [middle, circle] = smallest_circle(a, b, c);
    // A triangle of hardly any area has no plane that could hold anything off: it counts as a ball.
    const Vector3f cross = (b - a).cross(c - a);
    const float twice_area = cross.norm();
    const Vector3f normal =
        twice_area > 0.1F * circle * circle ? Vector3f(cross / twice_area) : Vector3f::Zero();
    x_[at] = middle[0];
    y_[at] = middle[1];
    z_[at] = middle[2];
    circle_[at] = circle + rounding;
    nx_[at] = normal[0];
    ny_[at] = normal[1];
    nz_[at] = normal[2];
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
            // In the open: as far as the nearest triangle there is nothing to gather. It is not far from what
            // the sphere touched or was nearest to before.
            const auto nearest = surface.closest_point(centre, reach_ + most_margin, nearest_);
            if (nearest) nearest_ = nearest->slot;
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
            x_[at] = y_[at] = z_[at] = nx_[at] = ny_[at] = nz_[at] = 0;
            circle_[at] = -1e6F;
        }
        return true;
    }
    reach_ = -1;
    return false;
}

// A triangle in the plane at height h over the middle of the way, its circle's centre c beside it in that
// plane at rho, is at least as far as sqrt(h² + (rho - circle)²) from the middle.
std::optional<SweepContact> Neighbourhood::sweep_gathered(const CollisionSurface& surface,
                                                          const Vector3d& from, const Vector3d& way,
                                                          double radius, double limit) noexcept {
    SweepContact best;
    best.fraction = limit;
    best.slot = -1;
    const auto test = [&](std::int32_t slot) {
        const auto contact = sweep_sphere_triangle(from, way, radius, best.fraction, surface.corners(slot));
        if (!contact || (best.slot >= 0 && contact->fraction >= best.fraction)) return;
        best = {contact->fraction, contact->point, contact->normal, surface.mesh_triangle(slot), slot};
    };
    // What held the sphere last time mostly does so again, and then little is left of the way.
    if (hint_ >= 0) test(hint_);
    const Vector3f middle = (from + 0.5 * best.fraction * way - centre_).cast<float>();
    const float reach = static_cast<float>(radius + 0.5 * best.fraction * way.norm()) + rounding;
    for (std::size_t first = 0; first < count_; first += lanes) {
        const Float4 x = load(&x_[first]) - middle[0], y = load(&y_[first]) - middle[1],
                     z = load(&z_[first]) - middle[2];
        const Float4 circle = load(&circle_[first]);
        const Float4 squared = x * x + y * y + z * z;
        Mask4 candidates = (squared <= (circle + reach) * (circle + reach)) & (circle > 0);
        if (!any(candidates)) continue;
        const Float4 height = load(&nx_[first]) * x + load(&ny_[first]) * y + load(&nz_[first]) * z;
        const Float4 left = reach * reach - height * height;
        candidates &= left >= 0;
        const Float4 beside = circle + root(left);
        candidates &= squared - height * height <= beside * beside * widening;
        if (!any(candidates)) continue;
        for (std::size_t lane = 0; lane < lanes; ++lane)
            if (candidates[lane] && slots_[first + lane] != hint_) test(slots_[first + lane]);
    }
    if (best.slot < 0) return std::nullopt;
    hint_ = nearest_ = best.slot;
    return best;
}

std::optional<SweepContact> Neighbourhood::sweep_sphere(const CollisionSurface& surface, const Vector3d& from,
                                                        const Vector3d& to, double radius) noexcept {
    const Vector3d way = to - from;
    const double length = way.norm();
    if (!(length > 0)) return std::nullopt;
    if (length > jump * most_margin) return surface.sweep_sphere(from, to, radius, hint_);
    double done = 0;
    for (int piece = 0; piece < most_pieces; ++piece) {
        const Vector3d start = from + done * way;
        const double rest = (1 - done) * length;
        double step = room(start, radius);
        if (step < rest && step < 0.25 * margin_) {
            // In contact the way leads far below the surface, and the sphere will not follow: one margin is
            // enough.
            if (!gather(surface, start, radius, std::min(rest, margin_))) break;
            step = room(start, radius);
        }
        const double limit = step < rest ? done + step / length : 1;
        // A sphere in contact is stopped at once, where few triangles are in question.
        if (piece == 0 && limit * length > 4 * first_piece)
            if (const auto contact = sweep_gathered(surface, from, way, radius, first_piece / length))
                return contact;
        if (const auto contact = sweep_gathered(surface, from, way, radius, limit)) return contact;
        if (limit == 1) return std::nullopt;
        done = limit;
    }
    return surface.sweep_sphere(from, to, radius, hint_);
}

}  // namespace palpate::collision
