// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/solid/solid_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/collision/segment_queries.hpp"
#include "runtime/collision/tree_pairs.hpp"

namespace palpate::haptics {

using collision::Feature;
using collision::has_bit;
using collision::TriangleCorners;
using Eigen::Vector3d;

namespace {

constexpr double gathered_slack =
    1;                            // mm: no motion of less brings near what was not near when it was gathered
constexpr double kept_slack = 1;  // mm: the same of what is kept for a patch
constexpr double farthest_asked = 50;    // mm: beyond, nothing is asked how far it is
constexpr double float_rounding = 1e-4;  // mm: of float32 about distances that triangles are left alone by

// How far the balls about two segments are apart, mm.
double balls_apart(const Vector3d& a0, const Vector3d& a1, const Vector3d& b0, const Vector3d& b1) noexcept {
    return 0.5 * ((a0 + a1 - b0 - b1).norm() - (a1 - a0).norm() - (b1 - b0).norm());
}

}  // namespace

// How far corners of a triangle are from the plane of another, on either side; zero if that has none.
class SolidWatch::Heights {
  public:
    Heights(const TriangleCorners& of, const TriangleCorners& over, const Vector3d& normal) noexcept {
        for (std::size_t i = 0; i < 3; ++i) heights_[i] = normal.dot(of[i] - over[0]);
    }
    double of_corner(std::size_t i) const noexcept { return std::abs(heights_[i]) - float_rounding; }
    double of_edge(std::size_t i) const noexcept { return beyond(heights_[i], heights_[(i + 1) % 3]); }
    double of_all() const noexcept {
        const auto [low, high] = std::minmax({heights_[0], heights_[1], heights_[2]});
        return beyond(low, high);
    }

  private:
    // Zero where the plane runs between the two.
    static double beyond(double a, double b) noexcept {
        return a * b > 0 ? std::min(std::abs(a), std::abs(b)) - float_rounding : 0;
    }
    std::array<double, 3> heights_;
};

void SolidWatch::reset() noexcept {
    moved_ = turned_ = 0;
    gathered_ = overflowed_ = false;
    for (Patch& patch : patches_) {
        patch.wake = 0;
        patch.kept_until = -1;
        patch.kept = 0;
    }
    touch_count_ = plane_count_ = near_count_ = 0;
}

void SolidWatch::look(const ToolPose& pose) noexcept {
    if (gathered_) {
        if (pose.position == pose_.position && pose.orientation.coeffs() == pose_.orientation.coeffs())
            return;
        moved_ += (pose.position - pose_.position).norm();
        turned_ += rotation_between(pose_.orientation, pose.orientation).norm();
    }
    pose_ = pose;
    R_PT_ = pose.orientation.toRotationMatrix();
    const double since = moved_ - moved_gathered_ + (turned_ - turned_gathered_) * longest_arm_;
    if (!gathered_ || since > gathered_slack) gather();
    touch_count_ = plane_count_ = 0;
    overflowed_ = false;
    for (const std::int32_t near : std::span(near_).first(near_count_)) {
        const auto index = static_cast<std::size_t>(near);
        if (patches_[index].wake <= odometer(patches_[index])) look_at(index);
    }
}

void SolidWatch::gather() noexcept {
    near_count_ = 0;
    moved_gathered_ = moved_;
    turned_gathered_ = turned_;
    gathered_ = true;
    for (std::size_t index = 0; index < patches_.size(); ++index)
        if (patches_[index].wake <= odometer(patches_[index]) + gathered_slack)
            near_[near_count_++] = static_cast<std::int32_t>(index);
}

Vector3d SolidWatch::placed(const Vector3d& p) const noexcept {
    return pose_.position + R_PT_ * p;
}

// Where the patch's balls are; the triangles themselves where they are asked for.
void SolidWatch::place(const Patch& patch) noexcept {
    placed_count_ = static_cast<std::size_t>(patch.count);
    for (std::size_t k = 0; k < placed_count_; ++k) {
        const Ball& ball = balls_[static_cast<std::size_t>(patch.first) + k];
        placed_[k].centre = placed(ball.centre);
        placed_[k].radius = ball.radius;
        has_corners_[k] = false;
    }
}

std::size_t SolidWatch::patch_triangle(const Patch& patch, std::size_t k) const noexcept {
    return static_cast<std::size_t>(triangles_[static_cast<std::size_t>(patch.first) + k]);
}

const SolidWatch::Placed& SolidWatch::with_corners(const Patch& patch, std::size_t k) noexcept {
    Placed& triangle = placed_[k];
    if (has_corners_[k]) return triangle;
    has_corners_[k] = true;
    triangle.corners = tool_.corners(patch_triangle(patch, k));
    for (Vector3d& corner : triangle.corners) corner = placed(corner);
    triangle.normal = collision::unit_normal(triangle.corners);
    return triangle;
}

SolidWatch::Placed SolidWatch::surface_of(std::int32_t body, std::int32_t slot) const noexcept {
    const collision::CollisionSurface& surface = *bodies_[static_cast<std::size_t>(body)].surface;
    const collision::TriangleDisc& disc = surface.disc(slot);
    return {surface.corners(slot),
            {disc.centre[0], disc.centre[1], disc.centre[2]},
            {disc.normal[0], disc.normal[1], disc.normal[2]},
            static_cast<double>(disc.radius) + float_rounding};
}

// How far a ball about part of the tool and a body's triangle are apart at least, mm: by the ball about the
// triangle, or by its plane.
double SolidWatch::apart(const Ball& ball, std::int32_t body, std::int32_t slot) const noexcept {
    const collision::TriangleDisc& disc = bodies_[static_cast<std::size_t>(body)].surface->disc(slot);
    const Vector3d way = placed(ball.centre) - Vector3d(disc.centre[0], disc.centre[1], disc.centre[2]);
    const double height = std::abs(way.dot(Vector3d(disc.normal[0], disc.normal[1], disc.normal[2])) -
                                   static_cast<double>(disc.lift));
    return std::max(way.norm() - static_cast<double>(disc.radius), height) - ball.radius - float_rounding;
}

std::size_t SolidWatch::slots_about(const Ball& ball, std::size_t body, double reach) noexcept {
    const Vector3d centre = placed(ball.centre);
    return bodies_[body].surface->slots_near(centre, centre, ball.radius + reach, slots_);
}

// Finds the bodies' triangles that are close to a patch now or may be so soon.
void SolidWatch::keep(std::size_t index) noexcept {
    Patch& patch = patches_[index];
    patch.kept = 0;
    patch.kept_at = odometer(patch);
    patch.kept_until = patch.kept_at + kept_slack;
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        const std::size_t count = slots_about(patch.ball, body, close + kept_slack);
        if (count > slots_.size()) overflowed_ = true;
        for (const std::int32_t slot : std::span(slots_).first(std::min(count, slots_.size()))) {
            const double clear = apart(patch.ball, static_cast<std::int32_t>(body), slot) - close;
            if (clear > kept_slack) continue;
            if (patch.kept == static_cast<std::int32_t>(most_kept)) {
                patch.kept = -1;
                return;
            }
            const std::size_t place = index * most_kept + static_cast<std::size_t>(patch.kept++);
            kept_[place] = {{}, slot, static_cast<std::int32_t>(body)};
            wakes_[place] = static_cast<float>(std::max(clear, 0.0));
        }
    }
    if (patch.kept > 0) return;
    // Nothing is near: how far is it?
    const double far = patch.ball.radius + close + farthest_asked;
    double clear = farthest_asked;
    for (const SolidBody& body : bodies_) {
        const auto nearest = body.surface->closest_point(placed(patch.ball.centre), far);
        if (nearest) clear = std::min(clear, nearest->distance - patch.ball.radius - close - float_rounding);
    }
    patch.kept_until = patch.kept_at + std::max(clear, kept_slack);
}

void SolidWatch::look_at(std::size_t index) noexcept {
    Patch& patch = patches_[index];
    const double now = odometer(patch);
    if (patch.kept_until < now) keep(index);
    placed_count_ = 0;
    if (patch.kept < 0) {
        look_at_all(patch);
        patch.wake = now;
        return;
    }
    // A little less than so much, so that rounding lets nothing sleep that is close, however little the
    // tool moves.
    const auto since = static_cast<float>((1 - 1e-6) * (now - patch.kept_at));
    float wake = std::numeric_limits<float>::infinity();
    const std::size_t first = index * most_kept;
    for (std::size_t k = first; k < first + static_cast<std::size_t>(patch.kept); ++k) {
        if (wakes_[k] <= since) wakes_[k] = look_at_slot(patch, since, kept_[k]);
        wake = std::min(wake, wakes_[k]);
    }
    patch.wake = std::min(patch.kept_at + static_cast<double>(wake), patch.kept_until);
}

// Where more is near a patch than is kept.
void SolidWatch::look_at_all(const Patch& patch) noexcept {
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        const std::size_t count = std::min(slots_about(patch.ball, body, close), slots_.size());
        for (const std::int32_t slot : std::span(slots_).first(count)) {
            Kept anew{{}, slot, static_cast<std::int32_t>(body)};
            look_at_slot(patch, 0, anew);
        }
    }
}

// Takes down what is close of a patch and a body's triangle; returns when any of it may be so again.
float SolidWatch::look_at_slot(const Patch& patch, float since, Kept& kept) noexcept {
    const auto wake_after = [&](double least) {
        return since + static_cast<float>(std::max(least - close - float_rounding, 0.0));
    };
    const double clear = apart(patch.ball, kept.body, kept.slot);
    if (clear > close) return wake_after(clear);
    if (placed_count_ == 0) place(patch);
    const Placed surface = surface_of(kept.body, kept.slot);
    float wake = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < placed_count_; ++k) {
        if (kept.wakes[k] <= since) {
            double least = (placed_[k].centre - surface.centre).norm() - placed_[k].radius - surface.radius;
            if (!(least > close))
                least = look_at_pair({patch_triangle(patch, k), static_cast<std::size_t>(kept.slot),
                                      kept.body, with_corners(patch, k), surface});
            kept.wakes[k] = wake_after(least);
        }
        wake = std::min(wake, kept.wakes[k]);
    }
    return wake;
}

// Returns the least distance of what belongs to the two triangles, mm, or a bound below it where that is not
// close.
double SolidWatch::look_at_pair(const Pair& pair) noexcept {
    const Heights over_body(pair.tool.corners, pair.surface.corners, pair.surface.normal);
    if (over_body.of_all() > close) return over_body.of_all();
    const Heights over_tool(pair.surface.corners, pair.tool.corners, pair.tool.normal);
    if (over_tool.of_all() > close) return over_tool.of_all();
    const std::uint8_t mine = tool_.of(pair.triangle).own_vertices,
                       its =
                           bodies_[static_cast<std::size_t>(pair.body)].features->of(pair.slot).own_vertices;
    double least = look_at_edges(pair, over_body, over_tool);
    for (std::size_t i = 0; i < 3; ++i) {
        if (has_bit(mine, i)) least = std::min(least, look_at_vertex(pair, i, over_body.of_corner(i)));
        if (has_bit(its, i)) least = std::min(least, look_at_its_vertex(pair, i, over_tool.of_corner(i)));
    }
    return least;
}

PartingPlane SolidWatch::plane_between(const Vector3d& on_tool, const Vector3d& on_body,
                                       double distance) const noexcept {
    const Vector3d arm = on_tool - pose_.position;
    return {(on_tool - on_body) / distance, on_body, {arm, arm}, distance, false};
}

Vector3d SolidWatch::held(const Vector3d& p) const noexcept {
    return R_PT_.transpose() * (p - pose_.position);
}

// A vertex of the tool and the body's triangle.
double SolidWatch::look_at_vertex(const Pair& pair, std::size_t i, double height) noexcept {
    if (height > close) return height;
    const Vector3d& p = pair.tool.corners[i];
    const double clear = (p - pair.surface.centre).norm() - pair.surface.radius;
    if (clear > close) return clear;
    const auto foot = collision::closest_point_on_triangle(p, pair.surface.corners);
    const double distance = std::sqrt(foot.squared_distance);
    if (!(distance < close) || !(distance > 0)) return distance;
    const collision::SurfaceFeatures& features = *bodies_[static_cast<std::size_t>(pair.body)].features;
    const bool is_its = collision::belongs_to(features.of(pair.slot), foot);
    found(pair, plane_between(p, foot.point, distance), p,
          is_its && features.is_nearest(pair.slot, foot, p - foot.point));
    return distance;
}

// A vertex of the body and the tool's triangle. A vertex on a vertex was the tool's.
double SolidWatch::look_at_its_vertex(const Pair& pair, std::size_t i, double height) noexcept {
    if (height > close) return height;
    const Vector3d& p = pair.surface.corners[i];
    const double clear = (p - pair.tool.centre).norm() - pair.tool.radius;
    if (clear > close) return clear;
    auto foot = collision::closest_point_on_triangle(p, pair.tool.corners);
    const double distance = std::sqrt(foot.squared_distance);
    if (!(distance < close) || !(distance > 0)) return distance;
    const bool is_mine =
        foot.feature != Feature::vertex && collision::belongs_to(tool_.of(pair.triangle), foot);
    PartingPlane plane = plane_between(foot.point, p, distance);
    plane.turns = true;
    const Vector3d on_tool = foot.point;
    foot.point = held(on_tool);
    found(pair, plane, on_tool, is_mine && tool_.is_nearest(pair.triangle, foot, held(p) - foot.point));
    return distance;
}

// Edges of both. Where an end is nearest it is a vertex' pair.
double SolidWatch::look_at_edges(const Pair& pair, const Heights& over_body,
                                 const Heights& over_tool) noexcept {
    const collision::SurfaceFeatures& features = *bodies_[static_cast<std::size_t>(pair.body)].features;
    const std::uint8_t mine = tool_.of(pair.triangle).own_sharp_edges,
                       its = features.of(pair.slot).own_sharp_edges;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
        if (!has_bit(mine, i)) continue;
        if (over_body.of_edge(i) > close) {
            least = std::min(least, over_body.of_edge(i));
            continue;
        }
        const Vector3d &from = pair.tool.corners[i], &to = pair.tool.corners[(i + 1) % 3];
        for (std::size_t j = 0; j < 3; ++j) {
            if (!has_bit(its, j)) continue;
            if (over_tool.of_edge(j) > close) {
                least = std::min(least, over_tool.of_edge(j));
                continue;
            }
            const Vector3d &its_from = pair.surface.corners[j], &its_to = pair.surface.corners[(j + 1) % 3];
            const double clear = balls_apart(from, to, its_from, its_to);
            if (clear > close) {
                least = std::min(least, clear);
                continue;
            }
            const auto near = collision::closest_points_of_segments(from, to, its_from, its_to);
            const double distance = std::sqrt(near.squared_distance);
            least = std::min(least, distance);
            if (!(distance < close) || !(distance > 0)) continue;
            PartingPlane plane = plane_between(near.first, near.second, distance);
            plane.arms = {from - pose_.position, to - pose_.position};
            const bool within = near.s > 0 && near.s < 1 && near.t > 0 && near.t < 1;
            found(pair, plane, near.first,
                  within &&
                      features.is_nearest_on_edge(pair.slot, j, near.second, near.first - near.second) &&
                      tool_.is_nearest_on_edge(pair.triangle, i, held(near.first),
                                               held(near.second) - held(near.first)));
        }
    }
    return least;
}

void SolidWatch::found(const Pair& pair, const PartingPlane& plane, const Vector3d& on_tool,
                       bool is_nearest) noexcept {
    if (plane_count_ == planes_.size() || (is_nearest && touch_count_ == touches_.size())) {
        overflowed_ = true;
        return;
    }
    planes_[plane_count_++] = plane;
    if (!is_nearest) return;
    ToolTouch& touch = touches_[touch_count_++];
    touch.point = static_cast<std::int32_t>(pair.triangle);
    touch.body = pair.body;
    touch.press = 0;
    touch.distance = plane.distance - margin;
    touch.arm = on_tool - pose_.position;
    touch.slope << plane.normal, touch.arm.cross(plane.normal);
}

bool SolidWatch::meets() noexcept {
    if (overflowed_) return true;
    for (const PartingPlane& plane : std::span(planes_).first(plane_count_))
        if (plane.distance < least_gap) return true;
    return std::ranges::any_of(std::span(near_).first(near_count_), [&](std::int32_t near) {
        const Patch& patch = patches_[static_cast<std::size_t>(near)];
        if (patch.kept < 0) return cuts_any(patch);
        const auto kept = std::span(kept_).subspan(static_cast<std::size_t>(near) * most_kept,
                                                   static_cast<std::size_t>(patch.kept));
        return std::ranges::any_of(kept, [&](const Kept& it) { return cuts(patch, it); });
    });
}

// Where more is near a patch than is kept.
bool SolidWatch::cuts_any(const Patch& patch) noexcept {
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        const std::size_t count = std::min(slots_about(patch.ball, body, 0), slots_.size());
        for (const std::int32_t slot : std::span(slots_).first(count))
            if (cuts(patch, {{}, slot, static_cast<std::int32_t>(body)})) return true;
    }
    return false;
}

bool SolidWatch::cuts(const Patch& patch, const Kept& kept) noexcept {
    if (apart(patch.ball, kept.body, kept.slot) > 0) return false;
    place(patch);
    const TriangleCorners surface = bodies_[static_cast<std::size_t>(kept.body)].surface->corners(kept.slot);
    for (std::size_t k = 0; k < placed_count_; ++k) {
        const auto pair = collision::closest_points_of_triangles(with_corners(patch, k).corners, surface);
        if (!(pair.on_a.squared_distance > 0)) return true;
    }
    return false;
}

double SolidWatch::safe_part(const Twist& motion) const noexcept {
    if (overflowed_) return 0;
    constexpr int most_cuts = 8;  // of the part, until a plane is kept
    double part = 1;
    ToolPose end = moved(pose_, motion);
    Eigen::Matrix3d turn = (end.orientation * pose_.orientation.conjugate()).toRotationMatrix();
    for (const PartingPlane& plane : std::span(planes_).first(plane_count_)) {
        // What is nearer already comes no nearer.
        const double least = std::min(plane.distance - 1e-10, least_gap);
        const auto height = [&] {
            const Vector3d normal = plane.turns ? Vector3d(turn * plane.normal) : plane.normal;
            const auto over = [&](const Vector3d& arm) {
                return normal.dot(end.position + turn * arm - plane.on_body);
            };
            return std::min(over(plane.arms[0]), over(plane.arms[1]));
        };
        double at_end = height();
        for (int cut = 0; at_end < least; ++cut) {
            part *= cut < most_cuts ? 0.999 * (plane.distance - least) / (plane.distance - at_end) : 0.0;
            end = moved(pose_, part * motion);
            turn = (end.orientation * pose_.orientation.conjugate()).toRotationMatrix();
            if (!(part > 0)) return 0;
            at_end = height();
        }
    }
    return part;
}

}  // namespace palpate::haptics
