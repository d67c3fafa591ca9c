// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/segment_painter.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

#include "formats/model/errors.hpp"

namespace palpate {

SegmentPainter::SegmentPainter(const ImageGrid& grid, std::vector<Label> segments,
                               std::span<const std::size_t> voxels, Overlaps rule)
    : grid_(grid), segments_(std::move(segments)), rule_(rule), winners_(grid.voxel_count(), 0) {
    std::vector<std::size_t> order(segments_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (rule == Overlaps::smaller_wins)
        std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return voxels[a] > voxels[b]; });
    rank_.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) rank_[order[i]] = i;
}

LabelMap SegmentPainter::finish(const std::filesystem::path& path, const NoteSink& note) {
    constexpr std::size_t pairs_to_name = 4;
    std::string pairs;
    std::size_t named = 0;
    for (const auto& [pair, count] : shared_)
        if (++named <= pairs_to_name)
            pairs += fmt::format("{}'{}' and '{}' both claim {} voxels", pairs.empty() ? "" : ", ",
                                 segments_[pair.first].name, segments_[pair.second].name, count);
    if (named > pairs_to_name) pairs += fmt::format(", and {} more pairs", named - pairs_to_name);
    if (!pairs.empty() && rule_ == Overlaps::refuse)
        throw InvalidInput({path.string(), "segments overlap: " + pairs, "one segment per voxel",
                            "decide with '--overlaps later' or '--overlaps smaller', or separate them"});
    if (!pairs.empty() && note)
        note(pairs +
             (rule_ == Overlaps::later_wins ? "; the later one got them" : "; the smaller one got them"));
    std::vector<bool> occurs(segments_.size() + 1, false);
    for (std::uint16_t& winner : winners_) {
        occurs[winner] = true;
        if (winner != 0) winner = static_cast<std::uint16_t>(segments_[winner - 1U].value);
    }
    LabelMap map{grid_, std::move(winners_), {}};
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        if (occurs[i + 1])
            map.names.push_back(segments_[i]);
        else if (note)
            note(fmt::format("segment '{}' has no voxel", segments_[i].name));
    }
    std::ranges::sort(map.names, {}, &Label::value);
    return map;
}

}  // namespace palpate
