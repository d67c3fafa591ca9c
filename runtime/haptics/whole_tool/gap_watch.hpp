// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "runtime/haptics/tool_pose.hpp"
#include "runtime/haptics/whole_tool/near_gaps.hpp"
#include "runtime/haptics/whole_tool/tool_touch.hpp"

namespace palpate::haptics {

inline constexpr double travel_rounding = 1e-9;  ///< mm, of a sum of motions

/// Finds where a tool is near bodies. Everything is allocated on construction; all but that is realtime-safe.
/// A class that derives from this one defines its destructor, first of its virtual functions, beside its
/// constructor, as a ContactMethod does.
class GapWatch {
  public:
    virtual ~GapWatch();

    /// Forgets where the tool was.
    virtual void reset() noexcept = 0;
    /// The tool is free: from here on nothing that is found, to its last digit, may depend on the poses
    /// looked at before, so that a replay may begin here.
    virtual void set_free() noexcept {}
    /// Finds what is within reach, or not far beyond, at `pose`.
    virtual void look(const ToolPose& pose) noexcept = 0;
    /// Whether a triangle of the tool meets one of a body at a pose.
    virtual bool meets(const ToolPose& pose) const noexcept = 0;

    /// What was found, `distance` being how much farther than the reach it is apart: below zero where it
    /// presses.
    std::span<const ToolTouch> close() const noexcept { return gaps_.all(); }
    /// Has each press with `stiffness` (N/mm) times what it is short of the reach.
    void press(double stiffness) noexcept { gaps_.press(stiffness); }
    /// How far a motion moves any point of the tool at most, mm.
    double reach_of(const Twist& motion) const noexcept { return haptics::reach_of(motion, longest_arm_); }
    /// How far any point may go from the pose last looked at, mm. Where that is hardly any the next look()
    /// sees whether it meets a body.
    double longest_step() const noexcept { return gaps_.longest_step(); }
    /// Whether the pose last looked at meets a body, as far as longest_step() may have led there.
    bool met() const noexcept { return met_; }

  protected:
    /// `reach` and the tool's longest arm: mm. Where more than `most` gaps are found, the narrowest are kept.
    GapWatch(double reach, std::size_t most, double longest_arm)
        : gaps_(reach, most), longest_arm_(longest_arm) {}

    NearGaps gaps_;
    bool met_ = false;

  private:
    double longest_arm_;
};

}  // namespace palpate::haptics
