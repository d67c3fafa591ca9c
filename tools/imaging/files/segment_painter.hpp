// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: segments of several layers put into one label map.
#pragma once
#include <span>
#include <unordered_map>

#include "tools/imaging/files/image_files.hpp"

namespace palpate::imaging {

/// Paints segments that may overlap into one map, voxel by voxel, in any order.
class SegmentPainter {
  public:
    /// `segments` in the order of the file with values of their own; `voxels` of each, for smaller_wins.
    SegmentPainter(const ImageGrid& grid, std::vector<Label> segments, std::span<const std::size_t> voxels,
                   Overlaps rule);

    void paint(std::size_t offset, std::size_t segment) {
        std::uint32_t& claimants = claimants_[offset];
        claimants = claimants == 0 ? static_cast<std::uint32_t>(segment + 1) : joined_by(claimants, segment);
    }

    /// The map with the segments that occur. Throws InvalidInput naming `path` and the pairs that overlap if
    /// the rule is to refuse; otherwise a note tells them.
    LabelMap finish(const std::filesystem::path& path, const NoteSink& note);

  private:
    std::uint32_t joined_by(std::uint32_t set, std::size_t segment);
    std::string overlapping_pairs(std::span<const std::size_t> voxels_of_set) const;

    ImageGrid grid_;
    std::vector<Label> segments_;
    Overlaps rule_;
    std::vector<std::size_t> rank_;               // the higher one wins
    std::vector<std::vector<std::size_t>> sets_;  // of segments: none, each alone, then those that meet
    std::unordered_map<std::uint64_t, std::uint32_t> joins_;  // set and segment to the set of both
    std::vector<std::uint32_t> claimants_;                    // the set of each voxel
};

}  // namespace palpate::imaging
