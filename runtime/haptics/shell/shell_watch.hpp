// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/collision/field/distance_field.hpp"
#include "runtime/collision/points/point_shell.hpp"
#include "runtime/haptics/tool_pose.hpp"
#include "runtime/haptics/whole_tool/tool_touch.hpp"

namespace palpate::haptics {

/// Finds those points of one tool's shell that are inside a body or close to it, looking only at points that
/// may have got there: a point that is clear by some way is not looked at again before the tool has moved so
/// far. Everything is allocated on construction; look() is realtime-safe.
class ShellWatch {
  public:
    /// Points and fields must outlive this. `close`: mm from a body, within which points are found; less than
    /// the fields' band.
    ShellWatch(std::span<const collision::ShellPoint> points,
               std::span<const collision::DistanceField> fields, double close);

    /// Forgets where the tool was.
    void reset() noexcept;

    /// Finds what is close at `pose`, in ascending order of the points.
    void look(const ToolPose& pose) noexcept;
    std::span<const ToolTouch> close() const noexcept { return {found_.data(), found_count_}; }
    /// Has what is inside press with `stiffness` (N/mm) times its depth.
    void press(double stiffness) noexcept;
    /// Whether any of it is inside.
    bool touches() const noexcept;

    /// Points inside push, and meet nothing.
    static constexpr bool met() noexcept { return false; }

    /// How far a motion moves any point of the shell at most, mm.
    double reach_of(const Twist& motion) const noexcept { return haptics::reach_of(motion, longest_arm_); }

  private:
    struct Watched {
        double arm;   // mm, from the tool's origin
        double wake;  // mm on the odometer, at which the point may be close to a body
    };
    double odometer(const Watched& watched) const noexcept { return moved_ + turned_ * watched.arm; }
    void gather() noexcept;
    double way_until_close(const collision::DistanceField& field, const Eigen::Vector3d& p,
                           double interpolant) const noexcept;
    void look_at(std::int32_t point, const ToolPose& pose, const Eigen::Matrix3d& R_PT) noexcept;

    std::span<const collision::ShellPoint> points_;
    std::span<const collision::DistanceField> fields_;
    double close_;
    double longest_arm_ = 0;
    ToolPose pose_;                                    // that was looked at
    double moved_ = 0, turned_ = 0;                    // mm and rad since the odometer's zero
    double moved_gathered_ = 0, turned_gathered_ = 0;  // when near points were gathered
    bool gathered_ = false;
    std::vector<Watched> watched_;  // of each point
    // The first near_count_ are points that may be close a little way from where they were gathered.
    std::vector<std::int32_t> near_;
    std::vector<ToolTouch> found_;  // the first found_count_
    std::size_t near_count_ = 0, found_count_ = 0;
};

}  // namespace palpate::haptics
