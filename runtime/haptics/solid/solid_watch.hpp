// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/collision/collision_surface.hpp"
#include "runtime/collision/features/surface_features.hpp"
#include "runtime/haptics/tool_pose.hpp"
#include "runtime/haptics/whole_tool/tool_touch.hpp"

namespace palpate::haptics {

/// A body as the watch over a tool's surface sees it.
struct SolidBody {
    const collision::CollisionSurface* surface = nullptr;
    const collision::SurfaceFeatures* features = nullptr;  ///< of its slots
};

/// A plane between a part of the tool and one of a body that are near: as long as the tool's part stays above
/// it, the two do not meet.
struct PartingPlane {
    Eigen::Vector3d normal;   ///< unit, from the body to the tool, frame P
    Eigen::Vector3d on_body;  ///< the body's point, p_P, mm
    std::array<Eigen::Vector3d, 2>
        arms;         ///< of the tool's part, from its origin, mm, frame P: twice if it is a point
    double distance;  ///< of the two, mm
    bool turns;       ///< with the tool, whose face it goes along
};

/// Finds where the surface of a tool is close to bodies: vertices of either with faces of the other, and
/// edges with edges, looking only at patches of the tool that may have come close. The first of two surfaces
/// that are apart to meet are always such a pair. Everything is allocated on construction; look(), meets()
/// and safe_part() are realtime-safe.
class SolidWatch {
  public:
    /// How near is close, mm.
    static constexpr double close = 0.1;
    /// Triangles of a patch of the tool at most.
    static constexpr std::size_t most_in_patch = 8;
    /// Slots of bodies near a patch that are kept; where more are, all are looked at anew.
    static constexpr std::size_t most_kept = 192;

    /// Tool and bodies must outlive this.
    SolidWatch(const collision::SurfaceFeatures& tool, std::span<const SolidBody> bodies);

    /// Forgets where the tool was.
    void reset() noexcept;

    /// Finds what is close at `pose`; nothing to do where that is the pose last looked at.
    void look(const ToolPose& pose) noexcept;

    /// Pairs of points of which one is where its surface is locally nearest to the other, `distance` being
    /// how far they are farther apart than `margin`: a tool that moves has to keep these apart. In ascending
    /// order of the tool's triangles.
    std::span<ToolTouch> touches() noexcept { return {touches_.data(), touch_count_}; }
    /// Whether more were close than can be held: then nothing is known to be safe.
    bool overflowed() const noexcept { return overflowed_; }

    /// The distance that touches keep, mm.
    static constexpr double margin = 0.02;

    /// Whether a triangle of the tool cuts one of a body at the pose last looked at, or is as near as none
    /// may come.
    bool meets() noexcept;

    /// How much of a motion from the pose last looked at, 0 ... 1, the tool may go and meet nothing: what is
    /// parted by a plane stays so, and what is not close cannot be met by a motion that reaches no farther
    /// than longest_step(). Source: conservative advancement along the direction of the nearest points
    /// (Mirtich 1996).
    double safe_part(const Twist& motion) const noexcept;
    /// How far a motion may move any point of the tool, mm.
    static constexpr double longest_step() noexcept { return close - least_gap; }

    /// How far a motion moves any point of the tool at most, mm.
    double reach_of(const Twist& motion) const noexcept { return haptics::reach_of(motion, longest_arm_); }
    double longest_arm() const noexcept { return longest_arm_; }

    /// What two surfaces keep between them at least, mm.
    static constexpr double least_gap = 0.25 * margin;

  private:
    struct Kept {                                  // a triangle of a body near a patch of the tool
        std::array<float, most_in_patch> wakes{};  // of each of the patch's triangles, as SolidWatch::wakes_
        std::int32_t slot = 0, body = 0;
    };
    struct Placed {  // a triangle in frame P
        collision::TriangleCorners corners;
        Eigen::Vector3d centre, normal;
        double radius;  // about the centre
    };
    struct Pair {
        std::size_t triangle, slot;
        std::int32_t body;
        const Placed &tool, &surface;
    };
    class Heights;
    struct Ball {  // frame T
        Eigen::Vector3d centre;
        double radius;
    };
    struct Patch {
        Ball ball;
        double arm;          // of its farthest point, mm
        std::int32_t first;  // in triangles_
        std::int32_t count;
        double wake = 0;         // mm on the odometer, at which something may be close
        double kept_at = 0;      // the same, at which slots were kept
        double kept_until = -1;  // up to which nothing is close that is not kept
        std::int32_t kept = 0;   // how many; -1: more than fit
    };

    Ball ball_about(std::span<const std::int32_t> triangles) const;
    void part_in_patches(std::span<std::int32_t> triangles);
    double odometer(const Patch& patch) const noexcept { return moved_ + turned_ * patch.arm; }
    void gather() noexcept;
    void keep(std::size_t index) noexcept;
    std::size_t slots_about(const Ball& ball, std::size_t body, double reach) noexcept;
    void look_at(std::size_t index) noexcept;
    void place(const Patch& patch) noexcept;
    std::size_t patch_triangle(const Patch& patch, std::size_t k) const noexcept;
    const Placed& with_corners(const Patch& patch, std::size_t k) noexcept;
    Placed surface_of(std::int32_t body, std::int32_t slot) const noexcept;
    void look_at_all(const Patch& patch) noexcept;
    float look_at_slot(const Patch& patch, float since, Kept& kept) noexcept;
    double look_at_pair(const Pair& pair) noexcept;
    double look_at_vertex(const Pair& pair, std::size_t i, double height) noexcept;
    double look_at_its_vertex(const Pair& pair, std::size_t i, double height) noexcept;
    double look_at_edges(const Pair& pair, const Heights& over_body, const Heights& over_tool) noexcept;
    PartingPlane plane_between(const Eigen::Vector3d& on_tool, const Eigen::Vector3d& on_body,
                               double distance) const noexcept;
    Eigen::Vector3d held(const Eigen::Vector3d& p) const noexcept;
    double apart(const Ball& ball, std::int32_t body, std::int32_t slot) const noexcept;
    void found(const Pair& pair, const PartingPlane& plane, const Eigen::Vector3d& on_tool,
               bool is_nearest) noexcept;
    bool cuts_any(const Patch& patch) noexcept;
    bool cuts(const Patch& patch, const Kept& kept) noexcept;
    Eigen::Vector3d placed(const Eigen::Vector3d& p) const noexcept;

    const collision::SurfaceFeatures& tool_;
    std::span<const SolidBody> bodies_;
    double longest_arm_ = 0;
    ToolPose pose_;  // that was looked at
    Eigen::Matrix3d R_PT_ = Eigen::Matrix3d::Identity();
    double moved_ = 0, turned_ = 0;  // mm and rad since the odometer's zero
    double moved_gathered_ = 0, turned_gathered_ = 0;
    bool gathered_ = false, overflowed_ = false;
    std::vector<std::int32_t> triangles_;  // of the tool, patch by patch
    std::vector<Ball> balls_;              // about each of these
    std::vector<Patch> patches_;
    std::vector<Kept> kept_;          // most_kept of each patch
    std::vector<float> wakes_;        // of these: mm on the odometer since they were kept
    std::vector<std::int32_t> near_;  // patches, the first near_count_
    std::vector<std::int32_t> slots_;
    std::array<Placed, most_in_patch> placed_;  // the triangles of the patch looked at
    std::array<bool, most_in_patch> has_corners_{};
    std::vector<ToolTouch> touches_;
    std::vector<PartingPlane> planes_;
    std::size_t near_count_ = 0, touch_count_ = 0, plane_count_ = 0, placed_count_ = 0;
};

}  // namespace palpate::haptics
