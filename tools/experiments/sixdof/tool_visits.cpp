// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/sixdof/tool_visits.hpp"

#include <cmath>
#include <numbers>

namespace palpate::experiments {
namespace {

using devices::HandPath;
using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180;

double between(double low, double high, std::mt19937_64& random) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

Vector3d any_direction(std::mt19937_64& random) {
    std::normal_distribution<double> component(0, 1);
    return Vector3d(component(random), component(random), component(random)).normalized();
}

// The shaft up to `tilt` off the outward normal, turned about itself by any angle.
Quaterniond held_at(const Place& place, double tilt, std::mt19937_64& random) {
    const Vector3d outward = -place.direction;
    const Vector3d aside = any_direction(random).cross(outward).normalized();
    return Quaterniond(AngleAxisd(between(0, tilt, random), aside)) *
           Quaterniond::FromTwoVectors(Vector3d::UnitZ(), outward) *
           Quaterniond(AngleAxisd(between(0, 2 * std::numbers::pi, random), Vector3d::UnitZ()));
}

}  // namespace

ToolVisit pressing_visit(const Place& place, double reach, std::mt19937_64& random) {
    const Vector3d outward = -place.direction;
    const double speed = between(20, 200, random);
    const Quaterniond first = held_at(place, 40 * degree, random);
    const Quaterniond second =
        (Quaterniond(AngleAxisd(between(0, 30 * degree, random), any_direction(random))) * first)
            .normalized();
    const Vector3d along = 10 * any_direction(random).cross(outward).normalized();
    const Vector3d outside = place.entry + (reach + visit_start) * outward;
    const Vector3d pressed = place.entry + (reach - visit_depth) * outward;
    const double in = (visit_start + visit_depth) / speed, slide = 10 / std::min(speed, 50.0), rest = 0.3;
    std::vector<HandPath::Key> keys;
    const auto be_at = [&](double time, const Vector3d& p, const Quaterniond& q) {
        keys.push_back({.time = time, .position = p, .holds = true, .orientation = q});
    };
    be_at(0, outside, first);
    be_at(in, pressed, first);
    be_at(in + slide, pressed + along, second);
    be_at(in + slide + rest, pressed + along, second);
    be_at(2 * in + slide + rest, outside + along, second);
    return {place, HandPath(std::move(keys)), in + slide, in + slide + rest};
}

ToolVisit fast_visit(const Place& place, double reach, double stroke, std::mt19937_64& random) {
    const Vector3d outward = -place.direction;
    const double seconds = (visit_start + stroke) / between(50, 1000, random);
    const double turn = std::min(between(0, 20, random) * seconds, 90 * degree);
    const Quaterniond last = held_at(place, 30 * degree, random);
    const Quaterniond first = (Quaterniond(AngleAxisd(turn, any_direction(random))) * last).normalized();
    const Vector3d end = place.entry + (reach - stroke) * outward;
    std::vector<HandPath::Key> keys;
    keys.push_back({.time = 0,
                    .position = place.entry + (reach + visit_start) * outward,
                    .holds = true,
                    .orientation = first});
    keys.push_back({.time = seconds, .position = end, .holds = true, .orientation = last});
    keys.push_back({.time = seconds + 0.02, .position = end, .holds = true, .orientation = last});
    return {place, HandPath(std::move(keys)), seconds, seconds + 0.02};
}

}  // namespace palpate::experiments
