// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "formats/model/errors.hpp"
#include "runtime/devices/hand_path.hpp"

namespace palpate::devices {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double turning_speed = 1.5;  // rad/s, at the most: a choice

// Appends straight motions.
class Stroke {
  public:
    Stroke(const Vector3d& start, double speed, const Quaterniond& orientation = {0, 0, 0, 0})
        : keys_{{0, start, true, orientation}}, speed_(speed) {}

    void move_to(const Vector3d& p) { move_to(p, speed_); }
    void move_to(const Vector3d& p, double speed) { move_to(p, speed, keys_.back().orientation); }
    void move_to(const Vector3d& p, double speed, const Quaterniond& orientation) {
        const HandPath::Key& from = keys_.back();
        const double turn =
                         orientation.coeffs().isZero(0) ? 0 : from.orientation.angularDistance(orientation),
                     took = std::max((p - from.position).norm() / speed, turn / turning_speed);
        if (took > 0) keys_.push_back({from.time + took, p, true, orientation});
    }
    void hold(double seconds) {
        if (seconds > 0) be_at(keys_.back().time + seconds, keys_.back().position);
    }
    void be_at(double time, const Vector3d& p) { keys_.push_back({time, p, true, keys_.back().orientation}); }
    // Here and until the next motion ends.
    void let_go() { keys_.back().holds = false; }
    double time() const { return keys_.back().time; }
    HandPath path() const { return HandPath(keys_); }

  private:
    std::vector<HandPath::Key> keys_;
    double speed_;
};

// The tool's centre when its surface is `depth` below the rest surface, mm.
Vector3d centre_at(const TouchPoint& target, const ScriptSettings& settings, double depth) {
    return target.point + (settings.tool_radius - depth) * target.normal;
}

void check(const ScriptSettings& settings) {
    require_script("--speed", settings.speed, settings.speed > 0, "more than 0 mm/s");
    require_script("--depth", settings.depth, settings.depth >= 0, "0 mm or more");
    require_script("--seconds", settings.seconds, settings.seconds > 0, "more than 0 s");
}

// A number that depends on the seed alone, not on the library.
double uniform(std::mt19937_64& random, double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(random() >> 11), -53);
}

}  // namespace

void require_script(const char* option, double found, bool holds, const char* expected) {
    if (!holds || !std::isfinite(found)) throw UsageError({option, std::to_string(found), expected, ""});
}

HandPath press_path(const TouchPoint& target, const ScriptSettings& settings) {
    check(settings);
    const Vector3d outside = centre_at(target, settings, -std::min(target.clearance, 5.0));
    Stroke stroke(outside, settings.speed);
    do {
        stroke.move_to(centre_at(target, settings, settings.depth));
        stroke.hold(settings.hold_s);
        stroke.move_to(outside);
        stroke.hold(settings.hold_s);
    } while (stroke.time() < settings.seconds);
    return stroke.path();
}

HandPath slide_path(const TouchPoint& target, const ScriptSettings& settings) {
    check(settings);
    const Vector3d outside = centre_at(target, settings, -std::min(target.clearance, 5.0));
    const Vector3d deep = centre_at(target, settings, settings.depth);
    const Vector3d aside = settings.slide_length * target.tangent;
    Stroke stroke(outside, settings.speed);
    stroke.move_to(deep);
    // One slide to both sides and the way out again take this long.
    const double cycle = 4 * settings.slide_length / settings.speed,
                 out = (deep - outside).norm() / settings.speed;
    do {
        stroke.move_to(deep + aside);
        stroke.move_to(deep - aside);
        stroke.move_to(deep);
    } while (stroke.time() + cycle + out < settings.seconds);
    stroke.move_to(outside);
    return stroke.path();
}

HandPath random_path(const TouchPoint& target, const ScriptSettings& settings, std::uint64_t seed) {
    check(settings);
    std::mt19937_64 random(seed);
    const Vector3d outside = centre_at(target, settings, -std::min(target.clearance, 5.0));
    const Vector3d bitangent = target.normal.cross(target.tangent);
    const auto somewhere = [&] {
        const double angle = uniform(random, 0, 2 * std::numbers::pi),
                     aside = settings.slide_length * std::sqrt(uniform(random, 0, 1)),
                     depth = uniform(random, 0, settings.depth);
        return Vector3d(centre_at(target, settings, depth) +
                        aside * (std::cos(angle) * target.tangent + std::sin(angle) * bitangent));
    };
    const auto some_speed = [&] { return settings.speed * uniform(random, 0.1, 1); };
    const Quaterniond upright = settings.turn > 0
                                    ? Quaterniond::FromTwoVectors(Vector3d::UnitZ(), target.normal)
                                    : Quaterniond(0, 0, 0, 0);
    const auto turned = [&] {
        if (settings.turn == 0) return upright;
        const double angle = uniform(random, 0, 2 * std::numbers::pi),
                     tilt = uniform(random, 0, settings.turn),
                     roll = uniform(random, -settings.turn, settings.turn);
        const Vector3d axis = std::cos(angle) * target.tangent + std::sin(angle) * bitangent;
        return Quaterniond(AngleAxisd(tilt, axis) * upright * AngleAxisd(roll, Vector3d::UnitZ()));
    };
    Stroke stroke(outside, settings.speed, upright);
    do {
        const auto places = static_cast<int>(uniform(random, 1, 5));  // a push, and up to three slides
        for (int place = 0; place < places; ++place) {
            stroke.move_to(somewhere(), some_speed(), turned());
            stroke.hold(uniform(random, 0, settings.hold_s));
        }
        stroke.move_to(outside, some_speed(), upright);
    } while (stroke.time() < settings.seconds);
    return stroke.path();
}

HandPath tremble_path(const TouchPoint& target, const ScriptSettings& settings, std::uint64_t seed) {
    check(settings);
    constexpr double slowest_hz = 8, fastest_hz = 12, fade_s = 0.5, shortest_s = 1, step_s = 1e-3;
    struct Vibration {
        double angular_frequency, phase;
    };
    std::mt19937_64 random(seed);
    std::array<std::array<Vibration, 3>, 3> vibrations;
    for (auto& axis : vibrations)
        for (Vibration& vibration : axis) {
            vibration.angular_frequency = 2 * std::numbers::pi * uniform(random, slowest_hz, fastest_hz);
            vibration.phase = uniform(random, 0, 2 * std::numbers::pi);
        }

    const Vector3d outside = centre_at(target, settings, -std::min(target.clearance, 5.0));
    const Vector3d deep = centre_at(target, settings, settings.depth);
    const double out = (deep - outside).norm() / settings.speed;
    Stroke stroke(outside, settings.speed);
    stroke.move_to(deep);
    const double begin = stroke.time(), end = std::max(begin + shortest_s, settings.seconds - out);
    const auto count = static_cast<int>((end - begin) / step_s);
    for (int i = 1; i <= count; ++i) {
        const double time = begin + step_s * i;
        const double share = std::min({1.0, (time - begin) / fade_s, (end - time) / fade_s});
        Vector3d away = Vector3d::Zero();
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const Vibration& v : vibrations[axis])
                away[static_cast<Eigen::Index>(axis)] += std::sin(v.angular_frequency * time + v.phase);
        stroke.be_at(time, deep + settings.tremor / 3 * share * away);
    }
    stroke.move_to(outside);
    return stroke.path();
}

HandPath let_go_path(const TouchPoint& target, const ScriptSettings& settings) {
    check(settings);
    constexpr double wait_s = 0.5;
    const Vector3d outside = centre_at(target, settings, -std::min(target.clearance, 5.0));
    Stroke stroke(outside, settings.speed);
    do {
        stroke.move_to(centre_at(target, settings, settings.depth));
        stroke.hold(settings.hold_s);
        stroke.let_go();
        stroke.move_to(outside);
        stroke.let_go();
        stroke.hold(wait_s);
        stroke.hold(wait_s);
    } while (stroke.time() < settings.seconds);
    return stroke.path();
}

HandPath recorded_axis_path(const TouchPoint& target, const ScriptSettings& settings,
                            std::span<const double> values) {
    check(settings);
    const auto [low, high] = std::ranges::minmax_element(values);
    if (values.empty() || !(*high > *low) || !std::isfinite(*high - *low))
        throw InvalidInput({"recorded axis", "all of its values are the same, or not finite",
                            "values that vary", "name another --column"});
    const double outermost = -std::min(target.clearance, 5.0);
    std::vector<HandPath::Key> keys;
    keys.reserve(values.size());
    for (const double value : values)
        keys.push_back({1e-3 * static_cast<double>(keys.size()),
                        centre_at(target, settings,
                                  std::lerp(outermost, settings.depth, (value - *low) / (*high - *low)))});
    return HandPath(std::move(keys));
}

}  // namespace palpate::devices
