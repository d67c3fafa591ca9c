// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: segments of several layers put into one label map.
#pragma once
#include <map>
#include <span>

#include "tools/imaging/image_files.hpp"

namespace palpate {

/// Paints segments that may overlap into one map, voxel by voxel, in any order.
class SegmentPainter {
  public:
    /// `segments` in the order of the file with values of their own; `voxels` of each, for smaller_wins.
    SegmentPainter(const ImageGrid& grid, std::vector<Label> segments, std::span<const std::size_t> voxels,
                   Overlaps rule);

    void paint(std::size_t offset, std::size_t segment) {
        std::uint16_t& winner = winners_[offset];
        if (winner != 0) {
            ++shared_[{std::min<std::size_t>(winner - 1U, segment),
                       std::max<std::size_t>(winner - 1U, segment)}];
            if (rank_[segment] < rank_[winner - 1U]) return;
        }
        winner = static_cast<std::uint16_t>(segment + 1);
    }

    /// The map with the segments that occur. Throws InvalidInput naming `path` and the pairs that overlap if
    /// the rule is to refuse; otherwise a note tells them.
    LabelMap finish(const std::filesystem::path& path, const NoteSink& note);

  private:
    ImageGrid grid_;
    std::vector<Label> segments_;
    Overlaps rule_;
    std::vector<std::size_t> rank_;       // the higher one wins
    std::vector<std::uint16_t> winners_;  // index of the segment + 1; 0 is background
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> shared_;  // voxels by pair of segments
};

}  // namespace palpate
