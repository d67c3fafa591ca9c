// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/files/segment_painter.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <numeric>

#include "formats/model/errors.hpp"

namespace palpate::imaging {

// Sets of segments that share a voxel are kept one by one: without an end to them, a file of many layers
// would make more of them than any memory holds.
constexpr std::size_t most_claimants = 64;

SegmentPainter::SegmentPainter(const ImageGrid& grid, std::vector<Label> segments,
                               std::span<const std::size_t> voxels, Overlaps rule)
    : grid_(grid), segments_(std::move(segments)), rule_(rule), sets_(1), claimants_(grid.voxel_count(), 0) {
    std::vector<std::size_t> order(segments_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (const std::size_t segment : order) sets_.push_back({segment});
    if (rule == Overlaps::smaller_wins)
        std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return voxels[a] > voxels[b]; });
    rank_.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) rank_[order[i]] = i;
}

std::uint32_t SegmentPainter::joined_by(std::uint32_t set, std::size_t segment) {
    if (std::ranges::find(sets_[set], segment) != sets_[set].end()) return set;
    const auto [join, fresh] =
        joins_.try_emplace(std::uint64_t{set} << 32 | segment, static_cast<std::uint32_t>(sets_.size()));
    if (fresh) {
        if (sets_[set].size() == most_claimants)
            throw InvalidInput({"segmentation",
                                fmt::format("more than {} segments claim one voxel", most_claimants), "",
                                "export fewer segments at once"});
        std::vector<std::size_t> both = sets_[set];
        both.push_back(segment);
        sets_.push_back(std::move(both));
    }
    return join->second;
}

std::string SegmentPainter::overlapping_pairs(std::span<const std::size_t> voxels_of_set) const {
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> shared;
    for (std::size_t set = 0; set < sets_.size(); ++set)
        for (std::size_t i = 0; voxels_of_set[set] > 0 && i < sets_[set].size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                shared[std::minmax({sets_[set][i], sets_[set][j]})] += voxels_of_set[set];
    constexpr std::size_t pairs_to_name = 4;
    std::string pairs;
    std::size_t named = 0;
    for (const auto& [pair, count] : shared)
        if (++named <= pairs_to_name)
            pairs += fmt::format("{}'{}' and '{}' both claim {} voxels", pairs.empty() ? "" : ", ",
                                 segments_[pair.first].name, segments_[pair.second].name, count);
    if (named > pairs_to_name) pairs += fmt::format(", and {} more pairs", named - pairs_to_name);
    return pairs;
}

LabelMap SegmentPainter::finish(const std::filesystem::path& path, const NoteSink& note) {
    std::vector<std::size_t> voxels_of_set(sets_.size(), 0);
    for (const std::uint32_t set : claimants_) ++voxels_of_set[set];
    const std::string pairs = overlapping_pairs(voxels_of_set);
    if (!pairs.empty() && rule_ == Overlaps::refuse)
        throw InvalidInput({path.string(), "segments overlap: " + pairs, "one segment per voxel",
                            "decide with 'palpate import ... --overlaps later' or '... --overlaps smaller', "
                            "or separate them"});
    if (!pairs.empty() && note)
        note(pairs +
             (rule_ == Overlaps::later_wins ? "; the later one got them" : "; the smaller one got them"));
    std::vector<bool> occurs(segments_.size(), false);
    std::vector<std::uint16_t> value_of_set(sets_.size(), 0);
    for (std::size_t set = 1; set < sets_.size(); ++set) {
        const std::size_t winner =
            *std::ranges::max_element(sets_[set], {}, [&](std::size_t segment) { return rank_[segment]; });
        value_of_set[set] = static_cast<std::uint16_t>(segments_[winner].value);
        if (voxels_of_set[set] > 0) occurs[winner] = true;
    }
    LabelMap map{grid_, std::vector<std::uint16_t>(claimants_.size()), {}};
    std::ranges::transform(claimants_, map.labels.begin(), [&](auto set) { return value_of_set[set]; });
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        if (occurs[i])
            map.names.push_back(segments_[i]);
        else if (note)
            note(fmt::format("segment '{}' has no voxel", segments_[i].name));
    }
    std::ranges::sort(map.names, {}, &Label::value);
    return map;
}

}  // namespace palpate::imaging
