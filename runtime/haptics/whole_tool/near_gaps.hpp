// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/haptics/whole_tool/tool_touch.hpp"

namespace palpate::haptics {

/// Two surfaces' points that are near each other, frame P.
struct Gap {
    std::int32_t triangle = 0, body = 0;  ///< the tool's triangle, and the body
    Eigen::Vector3d on_tool{0, 0, 0}, on_body{0, 0, 0};
    double distance = 0;  ///< mm, above zero

    Eigen::Vector3d normal() const noexcept { return (on_tool - on_body) / distance; }
};

/// Places where a tool is near bodies, each a spring from a reach on, before surfaces meet. Everything is
/// allocated on construction.
class NearGaps {
  public:
    /// How far beyond its reach gaps are to be found, of the reach: so far a step may take a point at most.
    static constexpr double ahead = 0.5;

    /// `reach`: mm. Where there are more than `most`, the narrowest count.
    NearGaps(double reach, std::size_t most) : reach_(reach), touches_(most) {}

    /// How near to each other the points of a gap are to be, mm.
    double within() const noexcept { return (1 + ahead) * reach_; }
    /// Nothing is known of a tool that comes from elsewhere.
    void forget() noexcept {
        count_ = 0;
        least_ = 0;
    }
    /// Forgets all for a tool whose tip's centre is at `tip` (p_P, mm).
    void begin(const Eigen::Vector3d& tip) noexcept {
        tip_ = tip;
        count_ = 0;
        least_ = within();
    }
    /// The tool is so near to a body somewhere, mm.
    void saw(double distance) noexcept { least_ = std::min(least_, distance); }
    void add(const Gap& gap) noexcept {
        ToolTouch* touch = nullptr;
        if (count_ < touches_.size()) {
            touch = &touches_[count_++];
        } else {
            touch = &*std::ranges::max_element(touches_, {}, &ToolTouch::distance);
            if (touch->distance <= gap.distance - reach_) return;
        }
        const Eigen::Vector3d normal = gap.normal();
        touch->point = gap.triangle;
        touch->body = gap.body;
        touch->press = 0;
        touch->distance = gap.distance - reach_;
        touch->arm = gap.on_tool - tip_;
        touch->slope << normal, touch->arm.cross(normal);
    }
    /// All that were added, `distance` being how much farther than the reach they are apart: below zero where
    /// they press.
    std::span<const ToolTouch> all() const noexcept { return {touches_.data(), count_}; }
    /// Has each press with `stiffness` (N/mm) times what it is short of the reach.
    void press(double stiffness) noexcept {
        for (ToolTouch& touch : std::span(touches_).first(count_))
            touch.press = std::max(0.0, -stiffness * touch.distance);
    }
    /// How far any point may go from here, mm, so that nothing is met (conservative advancement, Mirtich
    /// 1996). Where that is hardly any, a little nevertheless, or nothing would come away again.
    double longest_step() const noexcept {
        return std::clamp(part_of_least * least_, least_step, ahead * reach_);
    }
    /// Whether a step from here may have been longer than what is known to be clear.
    bool is_tight() const noexcept { return part_of_least * least_ < least_step; }

  private:
    static constexpr double least_step = 0.005;   // mm, that is taken though nobody knows what it meets
    static constexpr double part_of_least = 0.9;  // of the least distance, that a step may take

    double reach_;
    std::vector<ToolTouch> touches_;  // the first count_
    std::size_t count_ = 0;
    double least_ = 0;
    Eigen::Vector3d tip_{0, 0, 0};
};

}  // namespace palpate::haptics
