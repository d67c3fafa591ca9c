// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace palpate::devices {

/// Where a scripted hand is at each time: straight lines between keys, standing still before and after.
/// Where orientations are known, it turns from one to the next by the shortest way at a constant rate.
class HandPath {
  public:
    struct Key {
        double time = 0;           ///< s
        Eigen::Vector3d position;  ///< mm, in the path's frame: P, or that of the device it moves
        bool holds = true;         ///< from this key to the next, whether the hand holds the device
        Eigen::Quaterniond orientation{0, 0, 0, 0};  ///< R of the tool's frame in the path's; zero: not known
        double jaw_angle = -1;                       ///< between a forceps' jaws, rad; negative: not known
    };

    /// Throws InvalidInput if there is no key, a number is not finite, times do not rise strictly, or some
    /// orientations are known, as unit quaternions, and some are not, or some jaw angles.
    explicit HandPath(std::vector<Key> keys);

    /// Position at `time` (s). Realtime-safe; logarithmic in the keys.
    Eigen::Vector3d at(double time) const noexcept;
    /// Orientation at `time` (s), zero where the path has none. Realtime-safe; logarithmic in the keys.
    Eigen::Quaterniond orientation_at(double time) const noexcept;
    /// Angle between a forceps' jaws at `time` (s), rad; negative where the path has none. Realtime-safe;
    /// logarithmic in the keys.
    double jaw_angle_at(double time) const noexcept;
    /// Whether the hand holds the device at `time` (s); before the first key as from it on. Realtime-safe.
    bool holds_at(double time) const noexcept;
    double duration() const noexcept { return keys_.back().time; }  ///< s
    std::span<const Key> keys() const noexcept { return keys_; }

  private:
    // The keys before and after, and how much of the way between them is gone.
    struct Between {
        const Key &before, &after;
        double part;
    };
    Between between(double time) const noexcept;

    std::vector<Key> keys_;
};

/// The path through a rigid motion: `X_BA` takes positions and orientations from the path's frame A to B.
HandPath mapped_path(const HandPath& path, const Eigen::Isometry3d& X_BA);

/// Where and how a script touches a surface, for a tool of radius r.
struct TouchPoint {
    Eigen::Vector3d point;    ///< on the rest surface, p_P, mm
    Eigen::Vector3d normal;   ///< unit, outwards
    Eigen::Vector3d tangent;  ///< unit, along which a slide goes
    double clearance = 5;     ///< free way of the tool outside the point, mm
};

/// Throws UsageError of `option` where a number that a script asks for is not finite or `holds` is not true.
void require_script(const char* option, double found, bool holds, const char* expected);

/// How deep and how fast a script moves.
struct ScriptSettings {
    double tool_radius = 1;   ///< mm
    double depth = 3;         ///< mm, of the tool's surface below the rest surface
    double speed = 20;        ///< mm/s, in and out and along
    double hold_s = 0.5;      ///< s at full depth
    double tremor = 0.3;      ///< mm to either side, along each axis, of a hand that trembles
    double slide_length = 4;  ///< mm to either side
    double seconds = 10;      ///< s; repeated until this time
    double turn = 0;  ///< rad by which a hand at random tilts and turns a tool at most; 0: it does not
};

/// Presses at the point along its normal and leaves, over and over. Starts clearance (at most 5 mm) outside.
HandPath press_path(const TouchPoint& target, const ScriptSettings& settings);

/// Presses once, slides to either side of the point and back until the time is over, then leaves.
HandPath slide_path(const TouchPoint& target, const ScriptSettings& settings);

/// Pushes at random places within slide_length of the point, as deep as `depth` at most and at a tenth of
/// `speed` to the whole; holds, slides to others, and leaves; over and over until the time is over, ending
/// outside. With `turn` it tilts the tool's shaft from the normal and turns it about the shaft on the way, at
/// 1.5 rad/s at the most, and holds it upright outside. The same seed gives the same path.
HandPath random_path(const TouchPoint& target, const ScriptSettings& settings, std::uint64_t seed);

/// Presses, trembles at full depth until the time is over, then leaves. Physiological tremor: along each axis
/// three vibrations of 8 to 12 Hz that add up to settings.tremor at most, their frequencies and phases by the
/// seed; they come and go within half a second. Frequencies: as usual in the field, a peak between 6 and 12
/// Hz (Lakie et al. 2015, J Physiol 593, 4411). Size: a choice; the default's 0.12 mm root mean square along
/// an axis are what an unpractised hand may have where eye surgeons who held still had 0.05 mm (Riviere,
/// Rader, Khosla 1997, Characteristics of hand motion of eye surgeons). A Touch's friction swallows it in the
/// hand of usual stiffness.
HandPath tremble_path(const TouchPoint& target, const ScriptSettings& settings, std::uint64_t seed);

/// Presses, lets go of the device at full depth, goes outside, and takes hold again there half a second after
/// it came; over and over.
HandPath let_go_path(const TouchPoint& target, const ScriptSettings& settings);

/// The motion of one recorded axis along the target's normal: `values`, one per millisecond, the smallest as
/// far outside as press_path() starts, the largest at settings.depth. Throws InvalidInput if they are all the
/// same, there is none, or one is not finite.
HandPath recorded_axis_path(const TouchPoint& target, const ScriptSettings& settings,
                            std::span<const double> values);

/// Reads one column (from 1) of a recording: rows of numbers, commas or blanks between; '#' and '%' start
/// comments; a line has 65 535 characters at most. Throws InvalidInput naming file and line.
std::vector<double> read_column(const std::filesystem::path& file, std::size_t column);

/// Reads a path from text: rows "x y z" (mm), one per millisecond, the first for the first tick, or "t x y
/// z" (s, mm); either followed by "qx qy qz qw", a quaternion of unit length to 1e-3 that turns the tool's
/// frame, whose z axis is the shaft, to the patient's. Commas or blanks between, '#' and '%' start comments.
/// A line has 65 535 characters at most. Throws InvalidInput naming file and line.
HandPath read_hand_path(const std::filesystem::path& file);

}  // namespace palpate::devices
