// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/collision/cones/cone_pairs.hpp"
#include "runtime/collision/cones/local_minima.hpp"
#include "runtime/collision/cones/normal_cone_tree.hpp"
#include "runtime/collision/triangle_queries.hpp"
#include "runtime/haptics/tool_pose.hpp"
#include "runtime/haptics/whole_tool/gap_watch.hpp"

namespace palpate::haptics {

/// Finds where the distance between a tool's surface and those of bodies has local minima within `reach` or a
/// little more: the spatialized normal cone search of Johnson, Willemsen, Cohen 2005, "Six degree-of-freedom
/// haptic rendering using spatialized normal cone search". There new minima are searched for in a loop of
/// their own and followed by local descent in the haptic one; here all are found in every look. The pairs of
/// triangles that may hold one are kept while the tool moves and turns a little, and one is asked again only
/// once the tool has come as far as the two were beyond reach.
class ConeWatch final : public GapWatch {
  public:
    /// Pairs of triangles that are kept; where more are near, all are searched for anew.
    static constexpr std::size_t most_kept = 16'384;
    /// Minima that are held; beyond, the nearest ones.
    static constexpr std::size_t most_touches = 256;

    /// Tool and bodies must outlive this. `reach`: mm.
    ConeWatch(const collision::NormalConeTree& tool, std::span<const collision::NormalConeTree> bodies,
              double reach);
    ~ConeWatch() override;

    void reset() noexcept override;
    void look(const ToolPose& pose) noexcept override;
    bool meets(const ToolPose& pose) const noexcept override;

  private:
    struct Kept {
        const collision::ConeNode *mine, *its;  // leaves
        std::int32_t body;
        double due;  // mm of the tool's triangle's travel, before which they are not within reach

        double arm() const noexcept { return static_cast<double>(mine->arm); }
    };
    // All that may hold a minimum until the tool has moved by more than the slack.
    template <typename Item>
    struct Near {
        Motion slack;
        std::vector<Item> items{};
        std::size_t count = 0;
        ToolPose at{};
        bool valid = false;

        void begin(const ToolPose& pose) noexcept {
            at = pose;
            valid = true;
            count = 0;
        }
        bool holds(const ToolPose& pose) const noexcept {
            if (!valid) return false;
            const Motion motion = motion_between(at, pose);
            return motion.turn <= slack.turn && motion.way <= slack.way;
        }
        std::span<const Item> all() const noexcept { return {items.data(), count}; }
    };
    void gather(const Eigen::Isometry3d& X_PT) noexcept;
    void refine(const Eigen::Isometry3d& X_PT) noexcept;
    void search(const Eigen::Isometry3d& X_PT) noexcept;
    void look_at_kept(const Eigen::Isometry3d& X_PT) noexcept;
    void look_at(const Eigen::Isometry3d& X_PT, Kept& pair) noexcept;
    collision::ConeReach reach_with(const Motion& slack) const noexcept;

    const collision::NormalConeTree& tool_;
    std::span<const collision::NormalConeTree> bodies_;
    ToolPose pose_;
    Motion travel_;  // of all looks together
    bool keeps_ = false;
    Near<Kept> around_;
    Near<std::size_t> closer_;  // of these
    std::int32_t placed_ = -1;  // the tool's triangle whose corners are these, frame P
    collision::TriangleCorners corners_;
    collision::PairMinima found_;  // of the pair that is looked at
};

}  // namespace palpate::haptics
