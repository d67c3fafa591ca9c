// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/recipes/job.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/image_files.hpp"

namespace palpate::imaging {
namespace {

using Kind = RecipeParameter::Kind;
using Range = RecipeParameter::Range;

// Centres of the strokes of each label, as seeds; at most `limit` of a label, evenly chosen.
std::vector<Seed> seeds_of_strokes(const LabelMap& strokes, std::size_t limit) {
    std::vector<Seed> seeds;
    const auto& size = strokes.grid.size;
    for (const Label& label : strokes.names) {
        std::vector<Eigen::Vector3d> points;
        std::size_t offset = 0;
        for (std::int32_t k = 0; k < size[2]; ++k)
            for (std::int32_t j = 0; j < size[1]; ++j)
                for (std::int32_t i = 0; i < size[0]; ++i, ++offset)
                    if (strokes.labels[offset] == label.value)
                        points.push_back(strokes.grid.point_of(Eigen::Vector3d(i, j, k)));
        const std::size_t stride = (points.size() + limit - 1) / limit;
        for (std::size_t n = 0; n < points.size(); n += stride) seeds.push_back({label.name, points[n]});
    }
    return seeds;
}

void add_seeds(NamedSeeds& seeds, const std::string& structure, const std::vector<Seed>& from) {
    for (const Seed& seed : seeds_of(from, structure, "structure '" + structure + "'"))
        seeds.own.push_back({structure, seed.p_P});
    seeds.all.insert(seeds.all.end(), from.begin(), from.end());
}

// Those of seeds_mm and seeds_file.
NamedSeeds written_points(const Parameters& p, const std::string& structure) {
    NamedSeeds seeds;
    for (const Eigen::Vector3d& point : p.points("seeds_mm")) seeds.own.push_back({structure, point});
    if (p.has("seeds_file")) add_seeds(seeds, structure, read_seeds(p.text("seeds_file")));
    return seeds;
}

}  // namespace

Mask Job::structure_named_by(const std::string& parameter) const {
    return mask_of(map, require_label(map, parameters.text(parameter), culprit()).value);
}

RecipeParameters concatenated(std::initializer_list<RecipeParameters> lists) {
    RecipeParameters all;
    for (const RecipeParameters& list : lists) all.insert(all.end(), list.begin(), list.end());
    return all;
}

RecipeParameters with_defaults(RecipeParameters parameters,
                               const std::map<std::string, std::string>& defaults) {
    for (const auto& [name, value] : defaults) {
        const auto found = std::ranges::find(parameters, name, &RecipeParameter::name);
        parameters.at(static_cast<std::size_t>(found - parameters.begin())).default_value = value;
    }
    return parameters;
}

RecipeParameters region_parameters() {
    return {{"center_mm", Kind::point, "mm", "", "centre x, y, z of the sphere it is cut to"},
            {"radius_mm", Kind::number, "mm", "", "radius of that sphere", Range::not_negative},
            {"box_min_mm", Kind::point, "mm", "", "lowest x, y, z of the box it is cut to"},
            {"box_max_mm", Kind::point, "mm", "", "highest x, y, z of that box"}};
}

Region region_of(const Parameters& parameters) {
    Region region;
    if (parameters.has("center_mm") || parameters.has("radius_mm"))
        region.sphere = {parameters.point("center_mm"), parameters.number("radius_mm")};
    if (parameters.has("box_min_mm") || parameters.has("box_max_mm"))
        region.box = {parameters.point("box_min_mm"), parameters.point("box_max_mm")};
    return region;
}

RecipeParameters seed_parameters(std::size_t most_strokes) {
    return {{"seeds_mm", Kind::points, "mm", "", "points x, y, z inside it (LPS); 'seeds' for short"},
            {"seeds_file", Kind::file, "", "",
             "3D Slicer points (.mrk.json, .fcsv): those labelled as the structure, or all if they share a "
             "label"},
            {"scribbles", Kind::file, "", "",
             fmt::format("label map with strokes, those labelled as the structure; thinned evenly to {} "
                         "points a label",
                         most_strokes)}};
}

NamedSeeds named_seeds(const Parameters& p, const std::string& structure, std::size_t most_strokes) {
    NamedSeeds seeds = written_points(p, structure);
    if (p.has("scribbles"))
        add_seeds(seeds, structure, seeds_of_strokes(read_label_map(p.text("scribbles")), most_strokes));
    return seeds;
}

std::vector<Eigen::Vector3d> seed_points(const Job& job) {
    std::vector<Eigen::Vector3d> points;
    for (const Seed& seed : named_seeds(job.parameters, job.structure.name).own) points.push_back(seed.p_P);
    return points;
}

std::vector<Eigen::Vector3d> few_seed_points(const Job& job) {
    constexpr std::size_t most = 5;
    if (const auto points = written_points(job.parameters, job.structure.name).own; points.size() > most)
        throw InvalidInput({job.culprit(), fmt::format("has {} seeds", points.size()),
                            fmt::format("1 to {} points inside it", most),
                            "keep those that lie apart and deep inside it, or draw strokes: scribbles=..."});
    return seed_points(job);
}

}  // namespace palpate::imaging
