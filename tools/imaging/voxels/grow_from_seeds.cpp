// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/grow_from_seeds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/model/errors.hpp"
#include "tools/imaging/voxels/coarse_grid.hpp"
#include "tools/imaging/voxels/seed_statistics.hpp"

namespace palpate::imaging {
namespace {

constexpr double statistics_radius = 4;    // mm
constexpr double smallest_spread = 0.005;  // of the volume's range of values
constexpr double length_cost = 0.1;        // per mm, in units of squared deviations
constexpr double cost_unit = 0.05;         // what one step of the queue stands for
constexpr std::uint32_t dearest_step = 4095;

// The range of values without its outermost hundredths, from a sample.
double range_of(const Volume& volume) {
    std::vector<float> sample;
    const std::size_t stride = std::max<std::size_t>(1, volume.values.size() / 100'000);
    for (std::size_t i = 0; i < volume.values.size(); i += stride) sample.push_back(volume.values[i]);
    std::ranges::sort(sample);
    return sample[sample.size() * 99 / 100] - sample[sample.size() / 100];
}

struct Competitor {
    std::string label;
    std::vector<Eigen::Vector3d> points;
    GreyStatistics grey;
    double tolerance = 0;
};

std::vector<Competitor> competitors_of(const Volume& volume, std::span<const Seed> seeds,
                                       const GrowParameters& parameters) {
    std::vector<Competitor> competitors;
    for (const Seed& seed : seeds) {
        auto found = std::ranges::find(competitors, seed.label, &Competitor::label);
        if (found == competitors.end())
            found = competitors.insert(found, {seed.label, {}, {}, parameters.tolerance});
        found->points.push_back(seed.p_P);
    }
    const double floor = std::max(smallest_spread * range_of(volume), 1e-6);
    for (Competitor& competitor : competitors) {
        std::vector<float> values = values_near(volume, competitor.points, statistics_radius);
        competitor.grey = robust_statistics(values);
        competitor.grey.sigma = std::max(competitor.grey.sigma, floor);
        if (const auto own = parameters.tolerances.find(competitor.label); own != parameters.tolerances.end())
            competitor.tolerance = own->second;
        if (competitor.label == "background") competitor.tolerance = std::numeric_limits<double>::infinity();
    }
    return competitors;
}

// Dijkstra with a ring of buckets, one per integer cost (Dial, 1969).
class Race {
  public:
    Race(const Volume& volume, const std::vector<Competitor>& competitors)
        : volume_(volume),
          competitors_(competitors),
          owner_(volume.values.size(), 0),
          cost_(volume.values.size(), std::numeric_limits<std::uint32_t>::max()),
          buckets_(dearest_step + 1) {}

    std::vector<std::uint16_t> run() {
        for (std::size_t n = 0; n < competitors_.size(); ++n)
            for (const Eigen::Vector3d& point : competitors_[n].points) {
                const auto [i, j, k] = voxel_of_seed(volume_.grid, point, competitors_[n].label);
                offer(volume_.grid.offset(i, j, k), static_cast<std::uint16_t>(n + 1), 0);
            }
        std::vector<std::uint32_t> bucket;
        for (std::uint32_t now = 0; waiting_ > 0; ++now) {
            std::swap(bucket, buckets_[now % buckets_.size()]);
            waiting_ -= bucket.size();
            for (const std::uint32_t offset : bucket)
                if (cost_[offset] == now) advance(offset, now);
            bucket.clear();
        }
        return std::move(owner_);
    }

  private:
    void offer(std::size_t offset, std::uint16_t owner, std::uint32_t cost) {
        if (cost >= cost_[offset]) return;
        cost_[offset] = cost;
        owner_[offset] = owner;
        buckets_[cost % buckets_.size()].push_back(static_cast<std::uint32_t>(offset));
        ++waiting_;
    }

    void advance(std::size_t from, std::uint32_t now) {
        const auto& size = volume_.grid.size;
        const auto row = static_cast<std::size_t>(size[0]), slice = row * static_cast<std::size_t>(size[1]);
        const std::array<std::size_t, 3> stride{1, row, slice};
        const std::array<std::size_t, 3> index{from % row, from % slice / row, from / slice};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (index[axis] > 0) step(from, from - stride[axis], axis, now);
            if (index[axis] + 1 < static_cast<std::size_t>(size[axis]))
                step(from, from + stride[axis], axis, now);
        }
    }

    void step(std::size_t from, std::size_t to, std::size_t axis, std::uint32_t now) {
        const Competitor& mine = competitors_[owner_[from] - 1U];
        const double off = (volume_.values[to] - mine.grey.mean) / mine.grey.sigma,
                     change = (volume_.values[to] - volume_.values[from]) / mine.grey.sigma;
        if (std::abs(off) > mine.tolerance) return;
        const double cost = volume_.grid.spacing[static_cast<Eigen::Index>(axis)] *
                            (length_cost + off * off + change * change) / cost_unit;
        const double bounded = std::min(cost, static_cast<double>(dearest_step));
        offer(to, owner_[from], now + std::max(1U, static_cast<std::uint32_t>(std::lround(bounded))));
    }

    const Volume& volume_;
    const std::vector<Competitor>& competitors_;
    std::vector<std::uint16_t> owner_;
    std::vector<std::uint32_t> cost_;
    std::vector<std::vector<std::uint32_t>> buckets_;
    std::size_t waiting_ = 0;
};

}  // namespace

LabelMap grow_from_seeds(const Volume& volume, std::span<const Seed> seeds,
                         const GrowParameters& parameters) {
    if (seeds.empty())
        throw InvalidInput({"seeds", "there are none", "1 or more", "place a point in each structure"});
    for (const Seed& seed : seeds) voxel_of_seed(volume.grid, seed.p_P, "label '" + seed.label + "'");
    const auto block = blocks_of(volume.grid, parameters.spacing_mm);
    const bool blocks = block != std::array{1, 1, 1};
    const Volume coarse = blocks ? coarsen(volume, block) : Volume();
    const Volume& worked = blocks ? coarse : volume;
    const std::vector<Competitor> competitors = competitors_of(worked, seeds, parameters);
    std::vector<std::uint16_t> owner = Race(worked, competitors).run();

    LabelMap map{volume.grid, {}, {}};
    std::vector<std::uint16_t> value_of(competitors.size() + 1, 0);
    for (std::size_t n = 0; n < competitors.size(); ++n) {
        if (competitors[n].label == "background") continue;
        const auto value = static_cast<std::uint16_t>(map.names.size() + 1);
        value_of[n + 1] = value;
        map.names.push_back({value, competitors[n].label, default_label_colour(value)});
    }
    for (std::uint16_t& label : owner) label = value_of[label];
    if (!blocks) {
        map.labels = std::move(owner);
        return map;
    }
    map.labels.reserve(map.grid.voxel_count());
    for (std::int32_t k = 0; k < map.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < map.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < map.grid.size[0]; ++i)
                map.labels.push_back(owner[worked.grid.offset(i / block[0], j / block[1], k / block[2])]);
    return map;
}

GrowParameters preview_parameters(const ImageGrid& grid) {
    constexpr double most_blocks = 400'000;
    const double volume = static_cast<double>(grid.voxel_count()) * grid.voxel_volume();
    GrowParameters parameters;
    parameters.spacing_mm = std::cbrt(volume / most_blocks);
    const auto blocks = [&] {
        return static_cast<double>(coarse_grid(grid, blocks_of(grid, parameters.spacing_mm)).voxel_count());
    };
    while (blocks() > most_blocks) parameters.spacing_mm *= 1.1;
    return parameters;
}

}  // namespace palpate::imaging
