// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/collision/cones/local_minima.hpp"
#include "runtime/collision/cones/normal_cone_tree.hpp"
#include "runtime/collision/triangle_queries.hpp"
#include "runtime/haptics/tool_pose.hpp"
#include "runtime/haptics/whole_tool/tool_touch.hpp"

namespace palpate::haptics {

/// Finds where the distance between a tool's surface and those of bodies has local minima within `reach` or a
/// little more: the spatialized normal cone search of Johnson, Willemsen, Cohen 2005, "Six degree-of-freedom
/// haptic rendering using spatialized normal cone search". The pairs of triangles that may hold one are kept
/// while the tool moves and turns a little. Everything is allocated on construction; look() and meets() are
/// realtime-safe.
class ConeWatch {
  public:
    /// Pairs of triangles that are kept; where more are near, all are searched for anew.
    static constexpr std::size_t most_kept = 16'384;
    /// Minima that are held; beyond, the nearest ones.
    static constexpr std::size_t most_touches = 256;

    /// Tool and bodies must outlive this. `reach`: mm.
    ConeWatch(const collision::NormalConeTree& tool, std::span<const collision::NormalConeTree> bodies,
              double reach);

    /// Forgets where the tool was.
    void reset() noexcept {
        around_.valid = closer_.valid = met_ = false;
        least_ = 0;
    }

    /// How far beyond its reach it finds minima, of the reach: so far a step may take a point at most.
    static constexpr double ahead = 0.5;

    /// Finds what is within reach, or not far beyond, at `pose`.
    void look(const ToolPose& pose) noexcept;
    /// The minima, `distance` being how much farther than `reach` they are apart: below zero where they
    /// press.
    std::span<const ToolTouch> close() const noexcept { return {touches_.data(), touch_count_}; }
    /// Has each press with `stiffness` (N/mm) times what it is short of `reach`.
    void press(double stiffness) noexcept;

    /// Whether a triangle of the tool meets one of a body at a pose.
    bool meets(const ToolPose& pose) const noexcept;

    /// How far a motion moves any point of the tool at most, mm.
    double reach_of(const Twist& motion) const noexcept {
        return haptics::reach_of(motion, tool_.longest_arm());
    }
    /// How far any point may go from the pose last looked at, mm, so that nothing is met: the least distance
    /// is a minimum, too (conservative advancement, Mirtich 1996). Where that is hardly any, a little
    /// nevertheless, or nothing would come away again: then the next look() sees whether it meets a body.
    double longest_step() const noexcept;
    /// Whether the pose last looked at meets a body, as far as longest_step() may have led there.
    bool met() const noexcept { return met_; }

  private:
    struct Kept {
        const collision::ConeNode *mine, *its;  // leaves
        std::int32_t body;
    };
    // Pairs that are all that may hold a minimum until the tool has moved or turned by more.
    struct Near {
        double slack, turn;  // mm, rad
        std::vector<Kept> pairs{};
        std::size_t count = 0;
        ToolPose at{};
        bool valid = false;

        std::span<const Kept> all() const noexcept { return {pairs.data(), count}; }
    };
    bool holds(const Near& near) const noexcept;
    void gather(const Eigen::Isometry3d& X_PT) noexcept;
    void refine(const Eigen::Isometry3d& X_PT) noexcept;
    void search(const Eigen::Isometry3d& X_PT) noexcept;
    void look_at_kept(const Eigen::Isometry3d& X_PT) noexcept;
    void look_at(const Eigen::Isometry3d& X_PT, const Kept& pair) noexcept;
    void add(const Kept& pair, const Eigen::Vector3d& on_tool, const Eigen::Vector3d& on_body,
             double distance) noexcept;

    const collision::NormalConeTree& tool_;
    std::span<const collision::NormalConeTree> bodies_;
    double reach_, within_;  // mm, in which minima press and are found
    ToolPose pose_;
    bool keeps_ = false, met_ = false;
    double least_ = 0;  // mm, at the pose last looked at: the least distance, within_ at most
    Near around_, closer_;
    std::vector<ToolTouch> touches_;  // the first touch_count_
    std::size_t touch_count_ = 0;
    std::int32_t placed_ = -1;  // the tool's triangle whose corners are these, frame P
    collision::TriangleCorners corners_;
    collision::PairMinima found_;  // of the pair that is looked at
};

}  // namespace palpate::haptics
