// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/hand_path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>
#include <random>
#include <sstream>
#include <string>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

// Appends straight motions.
class Stroke {
  public:
    Stroke(const Vector3d& start, double speed) : keys_{{0, start}}, speed_(speed) {}

    void move_to(const Vector3d& p) { move_to(p, speed_); }
    void move_to(const Vector3d& p, double speed) {
        const double length = (p - keys_.back().position).norm();
        if (length > 0) keys_.push_back({keys_.back().time + length / speed, p});
    }
    void hold(double seconds) {
        if (seconds > 0) keys_.push_back({keys_.back().time + seconds, keys_.back().position});
    }
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
    const auto require = [](bool holds, const char* option, double found, const char* expected) {
        if (!holds) throw UsageError({option, std::to_string(found), expected, ""});
    };
    require(settings.speed > 0 && std::isfinite(settings.speed), "--speed", settings.speed,
            "more than 0 mm/s");
    require(settings.depth >= 0 && std::isfinite(settings.depth), "--depth", settings.depth, "0 mm or more");
    require(settings.seconds > 0 && std::isfinite(settings.seconds), "--seconds", settings.seconds,
            "more than 0 s");
}

// A number that depends on the seed alone, not on the library.
double uniform(std::mt19937_64& random, double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(random() >> 11), -53);
}

// The numbers of one row; nothing if something else stands there.
std::optional<std::vector<double>> numbers_of(std::string line) {
    line.erase(std::min(line.find('#'), line.size()));
    std::ranges::replace(line, ',', ' ');
    std::istringstream stream(line);
    stream.imbue(std::locale::classic());
    std::vector<double> numbers;
    std::string word;
    while (stream >> word) {
        std::istringstream one(word);
        one.imbue(std::locale::classic());
        double number = 0;
        if (!(one >> number) || one.peek() != EOF || !std::isfinite(number)) return std::nullopt;
        numbers.push_back(number);
    }
    return numbers;
}

}  // namespace

HandPath::HandPath(std::vector<Key> keys) : keys_(std::move(keys)) {
    if (keys_.empty()) throw InvalidInput({"hand path", "it has no positions", "one or more", ""});
    for (std::size_t i = 0; i < keys_.size(); ++i)
        if (!std::isfinite(keys_[i].time) || !keys_[i].position.allFinite() ||
            (i > 0 && keys_[i].time <= keys_[i - 1].time))
            throw InvalidInput({"hand path",
                                "key " + std::to_string(i) +
                                    " is not finite or not later than its "
                                    "predecessor",
                                "finite positions at rising times", ""});
}

Vector3d HandPath::at(double time) const noexcept {
    const auto after = std::ranges::upper_bound(keys_, time, {}, &Key::time);
    if (after == keys_.begin()) return keys_.front().position;
    if (after == keys_.end()) return keys_.back().position;
    const Key& a = *(after - 1);
    const double part = (time - a.time) / (after->time - a.time);
    return a.position + part * (after->position - a.position);
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
    Stroke stroke(outside, settings.speed);
    do {
        const auto places = static_cast<int>(uniform(random, 1, 5));  // a push, and up to three slides
        for (int place = 0; place < places; ++place) {
            stroke.move_to(somewhere(), some_speed());
            stroke.hold(uniform(random, 0, settings.hold_s));
        }
        stroke.move_to(outside, some_speed());
    } while (stroke.time() < settings.seconds);
    return stroke.path();
}

HandPath read_hand_path(const std::filesystem::path& file) {
    std::ifstream stream(file);
    if (!stream) throw InvalidInput({file.string(), "cannot be read", "", "check path and permissions"});
    std::vector<HandPath::Key> keys;
    std::size_t columns = 0;
    std::string line;
    for (std::size_t number = 1; std::getline(stream, line); ++number) {
        const std::string where = file.string() + ", line " + std::to_string(number);
        const auto row = numbers_of(line);
        if (!row) throw InvalidInput({where, "not a finite number", "x y z (mm) or t x y z (s, mm)", ""});
        if (row->empty()) continue;
        if (columns == 0 && (row->size() == 3 || row->size() == 4)) columns = row->size();
        if (row->size() != columns)
            throw InvalidInput({where, std::to_string(row->size()) + " numbers",
                                columns == 0 ? "3 (x y z, mm) or 4 (t x y z, s and mm)"
                                             : std::to_string(columns) + ", as in the rows before",
                                ""});
        HandPath::Key key;
        key.time = columns == 4 ? row->front() : 1e-3 * static_cast<double>(keys.size());
        key.position = {(*row)[columns - 3], (*row)[columns - 2], (*row)[columns - 1]};
        if (!keys.empty() && key.time <= keys.back().time)
            throw InvalidInput({where, "time " + std::to_string(key.time) + " s does not rise",
                                "more than " + std::to_string(keys.back().time) + " s", ""});
        keys.push_back(key);
    }
    if (keys.empty()) throw InvalidInput({file.string(), "it has no positions", "rows of x y z (mm)", ""});
    return HandPath(std::move(keys));
}

}  // namespace palpate
