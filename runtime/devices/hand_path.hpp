// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace palpate {

/// Where a scripted hand is at each time: straight lines between keys, standing still before and after.
class HandPath {
  public:
    struct Key {
        double time = 0;           ///< s
        Eigen::Vector3d position;  ///< p_P, mm
    };

    /// Throws InvalidInput if there is no key, a number is not finite, or times do not rise strictly.
    explicit HandPath(std::vector<Key> keys);

    /// Position at `time` (s). Realtime-safe; logarithmic in the keys.
    Eigen::Vector3d at(double time) const noexcept;
    double duration() const noexcept { return keys_.back().time; }  ///< s

  private:
    std::vector<Key> keys_;
};

/// Where and how a script touches a surface, for a tool of radius r.
struct TouchPoint {
    Eigen::Vector3d point;    ///< on the rest surface, p_P, mm
    Eigen::Vector3d normal;   ///< unit, outwards
    Eigen::Vector3d tangent;  ///< unit, along which a slide goes
    double clearance = 5;     ///< free way of the tool outside the point, mm
};

/// How deep and how fast a script moves.
struct ScriptSettings {
    double tool_radius = 1;   ///< mm
    double depth = 3;         ///< mm, of the tool's surface below the rest surface
    double speed = 20;        ///< mm/s, in and out and along
    double hold_s = 0.5;      ///< s at full depth
    double slide_length = 4;  ///< mm to either side
    double seconds = 10;      ///< s; repeated until this time
};

/// Presses at the point along its normal and lets go, over and over. Starts clearance (at most 5 mm) outside.
HandPath press_path(const TouchPoint& target, const ScriptSettings& settings);

/// Presses once, slides to either side of the point and back until the time is over, then lets go.
HandPath slide_path(const TouchPoint& target, const ScriptSettings& settings);

/// Pushes at random places within slide_length of the point, as deep as `depth` at most and at a tenth of
/// `speed` to the whole; holds, slides to others, and leaves; over and over until the time is over, ending
/// outside. The same seed gives the same path.
HandPath random_path(const TouchPoint& target, const ScriptSettings& settings, std::uint64_t seed);

/// Reads a path from text: rows "x y z" (mm), one per millisecond, or "t x y z" (s, mm); commas or blanks
/// between, '#' starts a comment. Throws InvalidInput naming file and line.
HandPath read_hand_path(const std::filesystem::path& file);

}  // namespace palpate
