// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/collision/convex/closest_features.hpp"
#include "runtime/collision/convex/convex_pieces.hpp"
#include "runtime/haptics/features/pair_index.hpp"
#include "runtime/haptics/tool_pose.hpp"
#include "runtime/haptics/whole_tool/gap_watch.hpp"

namespace palpate::haptics {

/// Finds where convex pieces of a tool's surface are near those of bodies, within `reach` or a little more:
/// closest features that are followed from look to look, and clusters of contacts, after Gregory,
/// Mascarenhas, Ehmann, Lin, Manocha 2000, "Six degree-of-freedom haptic display of polygonal models".
///
/// Where it is not as there, so far as its abstract and later papers tell, and why: pieces that overlap have
/// a depth there; here none ever do. Of a pair of pieces the nearest place counts; where face lies on face,
/// corners of either that lie over the other as well, or it would hop from one to the other; and only where
/// the surface beside it is no nearer, or the rims of all pieces around would push, too. The place of a
/// cluster is that of its narrowest gap, so that what pushes is a distance. A pair is asked again only once
/// the tool has come as far as the two were apart.
class FeatureWatch final : public GapWatch {
  public:
    /// Pairs of pieces that are followed; where more are near, triangles are searched anew in every look, and
    /// each that is near is a place.
    static constexpr std::size_t most_kept = 8192;
    /// Places before clusters are made; beyond, the nearest ones.
    static constexpr std::size_t most_found = 512;
    /// Vertices beside the nearest place of a pair.
    static constexpr std::size_t most_beside = 64;
    /// How far the tool's points of a cluster are from that of its nearest place, mm, and the cosine of the
    /// angle between their normals and its at least.
    static constexpr double cluster_radius = 1, cluster_cosine = 0.9;

    /// Tool and bodies must outlive this. `reach`: mm.
    FeatureWatch(const collision::ConvexPieces& tool, std::span<const collision::ConvexPieces> bodies,
                 double reach);
    ~FeatureWatch() override;

    void reset() noexcept override;
    void set_free() noexcept override { reset(); }  // where a search begins decides between places as near
    void look(const ToolPose& pose) noexcept override;
    bool meets(const ToolPose& pose) const noexcept override;

  private:
    struct Kept {
        collision::PiecePair features;
        std::int32_t body = 0;
        double arm = 0;             // mm, of the tool's piece
        double due = 0;             // mm of the piece's travel, before which they are not within reach
        bool was_followed = false;  // by now: else where to begin is a guess
    };
    struct Pairs {
        std::vector<Kept> kept;  // the first `count`
        std::size_t count = 0;
        PairIndex index;

        explicit Pairs(std::size_t most) : kept(most), index(2 * most) {}
        std::span<Kept> all() noexcept { return {kept.data(), count}; }
        void clear() noexcept {
            if (count > 0) index.clear();  // else there is nothing in it
            count = 0;
        }
    };

    bool holds() const noexcept;
    void gather(const Eigen::Isometry3d& X_PT) noexcept;
    bool gather(const Eigen::Isometry3d& X_PT, const Motion& slack) noexcept;
    bool keep(std::int32_t body, const collision::PieceNode& mine, const collision::PieceNode& its,
              double apart) noexcept;
    void follow(const Eigen::Isometry3d& X_PT) noexcept;
    void search(const Eigen::Isometry3d& X_PT) noexcept;
    bool consider(std::int32_t body, const collision::NearTriangles& near,
                  const Eigen::Isometry3d& X_PT) noexcept;
    void cluster() noexcept;

    const collision::ConvexPieces& tool_;
    std::span<const collision::ConvexPieces> bodies_;
    std::vector<collision::NearTriangles> beside_;  // the nearest place of a pair
    std::vector<Gap> found_;                        // the first found_count_
    std::size_t found_count_ = 0;
    Pairs now_, before_;  // the pairs that are near, and those that were before them
    ToolPose pose_, gathered_at_;
    Motion slack_;   // by which the tool may move from there until others are near
    Motion travel_;  // of all looks together
    bool valid_ = false, keeps_ = false;
};

}  // namespace palpate::haptics
