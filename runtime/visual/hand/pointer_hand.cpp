// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/hand/pointer_hand.hpp"

#include <algorithm>
#include <utility>

namespace palpate::visual {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double usual_depth = 3;                                                         // mm, at least
constexpr double depth_radii = 1.2;                                                       // of a larger tool
constexpr double sink_speed = 15, lift_speed = 40, travel_speed = 150, slide_speed = 60;  // mm/s
constexpr double far_depths = 3;         // of a press' depth: how far a wanted force is looked for
constexpr double slowest_sinking = 0.1;  // of that speed, where a wanted force is nearly felt
constexpr double longest_frame = 0.08;   // s: a slow picture must not make long steps
constexpr double pixel_step = 5;         // between two places that are looked up
constexpr int most_lookups = 48;         // a frame
constexpr double shortest_rest = 0.2;    // s over a place that only a jump leads to
constexpr double shortest_jump = 8;      // mm between two neighbouring pixels: the surface ends between them

double toward(double from, double to, double by) {
    return std::clamp(to, from - by, from + by);
}

}  // namespace

PointerHand::PointerHand(const Vector3d& start, double tool_radius)
    : radius_(tool_radius), depth_(std::max(usual_depth, depth_radii * tool_radius)), place_(start) {}

void PointerHand::point(const Vector2d& pixel) {
    pointer_ = pixel;
    led_ = seeking_ = true;
    rested_ = 0;
}

void PointerHand::press(bool on) {
    pressed_ = on;
    found_depth_.reset();
    if (on) led_ = seeking_ = true;
}

void PointerHand::deepen(double by) {
    if (wanted_ && pressed_ && !found_depth_) found_depth_ = std::max(least_depth, -offset_);
    double& depth = found_depth_ ? *found_depth_ : depth_;
    depth = std::clamp(depth + by, least_depth, most_depth);
}

void PointerHand::feel(double force, const std::optional<double>& wanted) {
    force_ = force;
    wanted_ = wanted;
}

void PointerHand::move(const Vector3d& by) {
    put(place_ + by);
}

void PointerHand::put(const Vector3d& place) {
    place_ = place;
    led_ = false;
    view_changed();
    found_ = false;
    anchor_.reset();
}

void PointerHand::view_changed() {
    seeking_ = false;
    reached_.reset();
}

Vector3d PointerHand::goal() const {
    return anchor_->point + (radius_ + offset_) * anchor_->normal;
}

// No farther towards the eye than it must: a fiftieth of the way, or twice as much, ... Whether there is a
// way.
bool PointerHand::go_around(const SeenPoint& next, const PointerScene& scene) {
    const Vector3d above = next.point + (radius_ + hover) * next.normal;
    Vector3d from = place_;
    Vector3d from_eye = place_ + next.seen_from - next.point;
    if (anchor_) {
        from = anchor_->point + (radius_ + hover) * anchor_->normal;
        from_eye = anchor_->seen_from;
    }
    std::vector<Vector3d> way;
    bool blocked = scene.blocked(from, above);
    for (double share = 0.02; blocked && share < 1; share *= 2) {
        way = {above + share * (next.seen_from - above), from + share * (from_eye - from)};
        blocked = scene.blocked(way[1], way[0]);
    }
    if (blocked) return false;
    offset_ = hover;
    detour_ = std::move(way);
    if (anchor_) detour_.push_back(from);
    return true;
}

void PointerHand::seek_next_pixel(const PointerScene& scene) {
    if (reached_) {
        const Vector2d way = pointer_ - *reached_;
        *reached_ += way * std::min(1.0, pixel_step / way.norm());
    } else {
        reached_ = pointer_;
    }
    const auto next = scene.under(*reached_);
    found_ = false;
    if (!next) return;
    const Vector3d before = anchor_ ? anchor_->point : place_;
    if ((next->point - before).norm() > std::max(shortest_jump, 3 * radius_)) {
        // What is only passed is not gone into, and nothing is gone through.
        if (*reached_ != pointer_ || rested_ < shortest_rest || !go_around(*next, scene)) {
            reached_.reset();
            return;
        }
    }
    anchor_ = next;
    found_ = true;
}

// A hand that feels its way in: the nearer to what is wanted, the slower.
void PointerHand::sink(double seconds) {
    double share = 1;
    if (wanted_ && !found_depth_) {
        if (force_ >= *wanted_) found_depth_ = std::max(least_depth, -offset_);
        share = std::max(slowest_sinking, 1 - force_ / *wanted_);
    }
    const double farthest = std::min(most_depth, far_depths * depth_);
    const double depth = found_depth_ ? *found_depth_ : wanted_ ? farthest : depth_;
    offset_ = toward(offset_, -depth, std::min(longest_frame, seconds) * share * sink_speed);
}

void PointerHand::advance(double seconds, const PointerScene& scene) {
    if (!led_) return;
    rested_ += seconds;
    if (!pressed_) offset_ = toward(offset_, hover, seconds * lift_speed);
    double left = std::min(longest_frame, seconds);
    for (int lookups = 0; lookups < most_lookups;) {
        const bool underway = !detour_.empty();
        if (underway || anchor_) {
            const Vector3d next = underway ? detour_.back() : goal();
            const double distance = (next - place_).norm();
            const double needed = distance / (pressed_ && !underway ? slide_speed : travel_speed);
            if (needed > left) {
                place_ += (next - place_) * (left / needed);
                return;
            }
            place_ = next;
            left -= needed;
            if (underway) {
                detour_.pop_back();
                continue;
            }
        }
        if (!seeking_ || (reached_ && *reached_ == pointer_)) break;
        seek_next_pixel(scene);
        if (!reached_) break;
        ++lookups;
    }
    if (!anchor_ || !detour_.empty()) return;
    if (pressed_ && (found_ || offset_ < hover)) sink(seconds);
    place_ = goal();
}

}  // namespace palpate::visual
