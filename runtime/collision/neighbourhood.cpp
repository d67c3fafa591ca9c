// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/neighbourhood.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::collision {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Margins grow and shrink until about so many triangles are gathered, and so many of them chosen: fewer are
// left too soon, more take longer to sift.
constexpr std::size_t few_gathered = 32, many_gathered = 96;
constexpr std::size_t few = 6, many = 20;
constexpr double first_margin = 0.3;                                          // mm
constexpr double least_margin = 0.02, most_margin = 2, most_wide_margin = 4;  // mm
constexpr double no_direction = 1e-3;  // mm: nearer, no direction leads from a triangle to the tool
constexpr double growth = 1.25;
constexpr double rounded_normal = 2e-7;  // error of a product with one, relative to the largest coordinate
constexpr int all_nodes = std::numeric_limits<int>::max();
// Of a tick, and of what is gathered altogether.
constexpr double least_nodes = 10, most_nodes = 100, usual_nodes = 300;
constexpr double start_share = 0.6;  // of the margin: with less room, the next surroundings are gathered
// Ticks in which the next surroundings should be gathered before they are needed.
constexpr double ticks_ahead = 10;
constexpr double ticks_at_once = 4;  // for which to gather in one go
// A way of this many margins is a jump, not the motion of a tick.
constexpr double jump = 8;
constexpr int most_pieces = 4;

// The first triangle that a sphere meets on its way, of those that are tried.
struct FirstContact {
    const CollisionSurface& surface;
    const Vector3d& from;
    const Vector3d& way;
    double radius;
    SweepContact best;

    FirstContact(const CollisionSurface& on, const Vector3d& start, const Vector3d& along, double of_sphere,
                 double limit) noexcept
        : surface(on), from(start), way(along), radius(of_sphere) {
        best.fraction = limit;
        best.slot = -1;
    }
    void test(std::int32_t slot) noexcept {
        const auto contact = sweep_sphere_triangle(from, way, radius, best.fraction, surface.corners(slot));
        if (!contact || !comes_before(contact->fraction, slot, best)) return;
        best = {contact->fraction, contact->point, contact->normal, surface.mesh_triangle(slot), slot};
    }
};

double followed(double margin, std::size_t count, std::size_t few_of_it, std::size_t many_of_it,
                double most) noexcept {
    if (count < few_of_it) return std::min(growth * margin, most);
    if (count > many_of_it) return std::max(margin / growth, least_margin);
    return margin;
}

}  // namespace

void Neighbourhood::clear() noexcept {
    for (Surroundings& surroundings : surroundings_) surroundings.clear();
    wide_margin_ = 3 * first_margin;
    margin_ = first_margin;
    step_ = 0;
    hint_ = -1;
    reach_ = -1;
    count_ = 0;
}

// Gathers in one go what is next to p.
void Neighbourhood::gather(const CollisionSurface& surface, const Vector3d& p, double radius) noexcept {
    next().begin(surface, p, radius, std::min(wide_margin_, std::max(first_margin, ticks_at_once * step_)));
    next().go_on(surface, all_nodes);
    current_ = 1 - current_;
}

void Neighbourhood::look_ahead(const CollisionSurface& surface, const Vector3d& p, double radius) noexcept {
    step_ = (p - last_).norm();
    last_ = p;
    const double room_left = around().room(p, radius);
    if (!next().under_way()) {
        if (room_left > std::max(start_share * wide_margin_, ticks_ahead * step_)) return;
        if (step_ > wide_margin_) return;
        next().begin(surface, p, radius, std::max(wide_margin_, ticks_ahead * step_));
    }
    const double wanted_nodes = usual_nodes * step_ / std::max(room_left, least_margin);
    next().go_on(surface, static_cast<int>(std::clamp(wanted_nodes, least_nodes, most_nodes)));
    if (next().under_way()) return;
    wide_margin_ = std::clamp(next().margin(), least_margin, wide_margin_);
    wide_margin_ = followed(wide_margin_, next().count(), few_gathered, many_gathered, most_wide_margin);
    if (next().room(p, radius) > room_left) current_ = 1 - current_;
}

// Chooses what a sphere about p needs that moves by `step`; false if there is too much.
bool Neighbourhood::choose(const CollisionSurface& surface, const Vector3d& p, double radius,
                           double step) noexcept {
    const double wanted = std::max(margin_, 1.5 * step),
                 enough = std::min(std::max(2 * step_, least_margin), 0.5 * margin_);
    double wide = around().room(p, radius);
    if (wide < step && wide < enough) {
        gather(surface, p, radius);
        wide = around().room(p, radius);
    }
    double margin = std::min(wanted, wide);
    for (int attempt = 0; attempt < 4 && margin > 0; ++attempt, margin /= 2)
        if (choose_within(p, radius + margin)) {
            if (attempt > 0)
                margin_ = std::max(margin, least_margin);
            else if (margin >= margin_ || count_ > many)
                margin_ = followed(margin_, count_, few, many, most_margin);
            // Where nothing was gathered, there is nothing as far as that.
            if (around().count() == 0) reach_ = radius + wide;
            return true;
        }
    reach_ = -1;
    return false;
}

// Chooses what is within `reach` of p by the discs' distance. The plane of each is square to the way from the
// disc's nearest point to p, as far out as the disc.
bool Neighbourhood::choose_within(const Vector3d& p, double reach) noexcept {
    const Surroundings& from = around();
    origin_ = p;
    reach_ = reach;
    count_ = 0;
    const Vector3f offset = (p - from.centre()).cast<float>();
    const float far = static_cast<float>(reach) + 2 * float_error;
    for (std::size_t first = 0; first < from.count(); first += lanes) {
        auto [x, y, z, circle, nx, ny, nz] = from.four(first);
        x -= offset[0];
        y -= offset[1];
        z -= offset[2];
        const Float4 squared = x * x + y * y + z * z;
        const Float4 height = nx * x + ny * y + nz * z;
        Mask4 chosen = (squared <= (circle + far) * (circle + far)) & (circle > 0);
        chosen &= absolute(height) <= far + plane_error * circle;
        if (!any(chosen)) continue;
        const Float4 px = x - height * nx, py = y - height * ny, pz = z - height * nz;
        const Float4 across = root(px * px + py * py + pz * pz);
        const Float4 beside = larger(across - circle, Float4{});
        const Float4 distance = root(height * height + beside * beside);
        chosen &= distance <= far + plane_error * circle;
        if (!any(chosen)) continue;
        const Float4 share = beside > 0 ? beside / across : Float4{};
        const Float4 scale = distance > static_cast<float>(no_direction) ? -1 / distance : Float4{};
        const Float4 mx = scale * (height * nx + share * px), my = scale * (height * ny + share * py),
                     mz = scale * (height * nz + share * pz);
        const Float4 along = mx * nx + my * ny + mz * nz;
        const Float4 ox = mx - along * nx, oy = my - along * ny, oz = mz - along * nz;
        const Float4 out = root(ox * ox + oy * oy + oz * oz);
        const Float4 d = mx * x + my * y + mz * z + circle * (out + plane_error);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            if (!chosen[lane]) continue;
            if (count_ == capacity) return false;
            nx_[count_] = mx[lane];
            ny_[count_] = my[lane];
            nz_[count_] = mz[lane];
            d_[count_] = d[lane];
            slots_[count_++] = from.slot(first + lane);
        }
    }
    // What is beyond the last seems infinitely far.
    for (std::size_t at = count_; at % lanes != 0; ++at) {
        nx_[at] = ny_[at] = nz_[at] = 0;
        d_[at] = -1e6F;
    }
    return true;
}

// Draws the plane between the sphere at `from` and the triangle, and tells whether the sphere's way crosses
// it.
bool Neighbourhood::may_touch(const CollisionSurface& surface, std::size_t at, const Vector3d& from,
                              const Vector3d& to, double radius) noexcept {
    const TriangleCorners t = surface.corners(slots_[at]);
    const TrianglePoint nearest = closest_point_on_triangle(from, t);
    const double distance = std::sqrt(nearest.squared_distance);
    if (distance < no_direction) return true;
    const Vector3f normal = ((from - nearest.point) / distance).cast<float>();
    const Vector3d n = normal.cast<double>();
    // The normal is rounded to float32, or for some compilers is not, so both count.
    double d = -std::numeric_limits<double>::infinity(), largest = 0;
    for (const Vector3d& corner : t) {
        d = std::max(d, n.dot(corner - origin_));
        largest = std::max(largest, (corner - origin_).cwiseAbs().maxCoeff());
    }
    d += rounded_normal * largest;
    nx_[at] = normal[0];
    ny_[at] = normal[1];
    nz_[at] = normal[2];
    d_[at] = static_cast<float>(d);
    const double limit = d + radius + static_cast<double>(float_error);
    return n.dot(from - origin_) <= limit || n.dot(to - origin_) <= limit;
}

std::optional<SweepContact> Neighbourhood::sweep_near(const CollisionSurface& surface, const Vector3d& from,
                                                      const Vector3d& way, double radius, double done,
                                                      double limit) noexcept {
    FirstContact first_contact(surface, from, way, radius, limit);
    const Vector3d start = from + done * way;
    const Vector3f a = (start - origin_).cast<float>();
    const float near = static_cast<float>(radius) + float_error;
    // What held the sphere last time mostly does so again, and then little is left of the way.
    if (hint_ >= 0) {
        if (!(hint_at_ < count_ && slots_[hint_at_] == hint_)) find_hint();
        if (hint_at_ == count_ || crosses(hint_at_, a, (from + limit * way - origin_).cast<float>(), near))
            first_contact.test(hint_);
    }
    const Vector3d to = from + first_contact.best.fraction * way;
    const Vector3f b = (to - origin_).cast<float>();
    for (std::size_t first = 0; first < count_; first += lanes) {
        const Float4 x = load(&nx_[first]), y = load(&ny_[first]), z = load(&nz_[first]);
        const Float4 behind = load(&d_[first]) + near;
        const Mask4 candidates =
            (x * a[0] + y * a[1] + z * a[2] <= behind) | (x * b[0] + y * b[1] + z * b[2] <= behind);
        if (!any(candidates)) continue;
        for (std::size_t lane = 0; lane < lanes; ++lane)
            if (candidates[lane] && slots_[first + lane] != hint_ &&
                may_touch(surface, first + lane, start, to, radius))
                first_contact.test(slots_[first + lane]);
    }
    return kept(first_contact.best);
}

std::optional<SweepContact> Neighbourhood::kept(const SweepContact& best) noexcept {
    if (best.slot < 0) return std::nullopt;
    hint_ = best.slot;
    return best;
}

// Whether a way from a to b leads to within `near` of a triangle's plane.
bool Neighbourhood::crosses(std::size_t at, const Vector3f& a, const Vector3f& b, float near) const noexcept {
    const Vector3f n(nx_[at], ny_[at], nz_[at]);
    return n.dot(a) <= d_[at] + near || n.dot(b) <= d_[at] + near;
}

void Neighbourhood::find_hint() noexcept {
    const auto end = slots_.begin() + static_cast<std::ptrdiff_t>(count_);
    hint_at_ = static_cast<std::size_t>(std::find(slots_.begin(), end, hint_) - slots_.begin());
}

// A triangle in the plane at height h over the middle of the way, its disc's centre c beside it in that
// plane at rho, is at least as far as sqrt(h² + (rho - circle)²) from the middle.
std::optional<SweepContact> Neighbourhood::sweep_around(const CollisionSurface& surface, const Vector3d& from,
                                                        const Vector3d& way, double radius,
                                                        double limit) noexcept {
    FirstContact first_contact(surface, from, way, radius, limit);
    const Surroundings& all = around();
    const Vector3d half = 0.5 * limit * way;
    const Vector3f middle = (from + half - all.centre()).cast<float>(), h = half.cast<float>();
    const float reach = static_cast<float>(radius + half.norm()) + float_error;
    const float near = static_cast<float>(radius) + float_error;
    for (std::size_t first = 0; first < all.count(); first += lanes) {
        auto [x, y, z, circle, nx, ny, nz] = all.four(first);
        x -= middle[0];
        y -= middle[1];
        z -= middle[2];
        const Float4 squared = x * x + y * y + z * z;
        const Float4 height = nx * x + ny * y + nz * z;
        const Float4 rise = nx * h[0] + ny * h[1] + nz * h[2];
        Mask4 candidates = (squared <= (circle + reach) * (circle + reach)) & (circle > 0);
        candidates &= absolute(height) - absolute(rise) <= near + plane_error * circle;
        if (!any(candidates)) continue;
        const Float4 px = x - height * nx, py = y - height * ny, pz = z - height * nz;
        const Float4 beside = larger(root(px * px + py * py + pz * pz) - circle, Float4{});
        const Float4 within = reach + plane_error * circle;
        candidates &= height * height + beside * beside <= within * within;
        if (!any(candidates)) continue;
        for (std::size_t lane = 0; lane < lanes; ++lane)
            if (candidates[lane]) first_contact.test(all.slot(first + lane));
    }
    return kept(first_contact.best);
}

std::optional<SweepContact> Neighbourhood::sweep_sphere(const CollisionSurface& surface, const Vector3d& from,
                                                        const Vector3d& to, double radius) noexcept {
    const Vector3d way = to - from;
    const double length = way.norm();
    if (!(length > 0)) return std::nullopt;
    if (length > jump * most_wide_margin && hint_ < 0) return surface.sweep_sphere(from, to, radius, hint_);
    double done = 0;
    for (int piece = 0; piece < most_pieces; ++piece) {
        const Vector3d start = from + done * way;
        const double rest = (1 - done) * length;
        double step = room(start, radius);
        // In contact the way leads far below the surface, and the sphere will not follow: one margin is
        // enough.
        if (step < rest && step < 0.25 * margin_)
            step = choose(surface, start, radius, std::min(rest, margin_)) ? room(start, radius) : 0;
        if (!(step > 0)) break;
        const double limit = step < rest ? done + step / length : 1;
        if (const auto contact = sweep_near(surface, from, way, radius, done, limit)) return contact;
        if (limit == 1) return std::nullopt;
        done = limit;
    }
    const double wide = around().room(from, radius);
    if (wide > done * length) {
        const double limit = wide < length ? wide / length : 1;
        if (const auto contact = sweep_around(surface, from, way, radius, limit)) return contact;
        if (limit == 1) return std::nullopt;
    }
    return surface.sweep_sphere(from, to, radius, hint_);
}

}  // namespace palpate::collision
