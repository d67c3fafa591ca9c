// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/contract/contract.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "formats/model/regions.hpp"
#include "tools/meshing/files/text.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"

namespace palpate::meshing {
namespace {

double longest_edge(const TetMesh& mesh, std::int32_t t) {
    const Tetrahedron& tet = mesh.tetrahedra[t];
    double longest = 0;
    for (const std::int32_t a : tet)
        for (const std::int32_t b : tet)
            longest = std::max(longest, (mesh.rest_positions[a] - mesh.rest_positions[b]).norm());
    return longest;
}

// Samples of the surface further than `limit` from the other surface, thinned to as far apart.
std::vector<Eigen::Vector3d> places_beyond(const RegionDistance& distance, double limit) {
    std::vector<Eigen::Vector3d> places;
    for (const FarPlace& sample : distance.far_places)
        if (sample.distance > limit && std::ranges::none_of(places, [&](const Eigen::Vector3d& p) {
                return (p - sample.p_P).norm() < limit;
            }))
            places.push_back(sample.p_P);
    return places;
}

std::vector<ComponentCover> cover_components(const RegionLabels& labels,
                                             const std::vector<std::int32_t>& painted) {
    const LabelComponents found = find_components(labels);
    std::vector<std::int64_t> covered(found.components.size(), 0);
    for (std::size_t v = 0; v < painted.size(); ++v)
        covered[found.component_of[v]] +=
            labels.regions[v] > 0 && painted[v] == labels.values[labels.regions[v] - 1U];
    std::vector<ComponentCover> result;
    for (std::size_t c = 0; c < covered.size(); ++c) {
        const LabelComponent& component = found.components[c];
        if (component.region == 0) continue;
        const auto voxels = static_cast<double>(component.voxels);
        result.push_back({labels.values[component.region - 1U], voxels * labels.grid.voxel_volume(),
                          component.centroid, static_cast<double>(covered[c]) / voxels});
    }
    return result;
}

}  // namespace

MeshMeasures measure(const TetMesh& mesh, const RegionLabels& labels,
                     std::span<const TriangleMesh> surfaces) {
    const std::vector<std::int32_t> painted = voxelise(mesh, labels.grid);
    return {measure(mesh), compare(mesh, labels, painted), region_distances(mesh, labels, surfaces),
            cover_components(labels, painted)};
}

std::vector<ContractCheck> check_shape(const QualityContract& contract, const TetMesh& mesh,
                                       const MeshQuality& quality) {
    using Bound = ContractCheck::Bound;
    ContractCheck smallest{.name = key_of(quality_fields, &QualityContract::min_dihedral_deg),
                           .measure = "the smallest dihedral angle",
                           .value = quality.min_dihedral_deg,
                           .bound = Bound::at_least,
                           .limit = contract.min_dihedral_deg,
                           .unit = "degrees",
                           .met = quality.min_dihedral_deg >= contract.min_dihedral_deg};
    ContractCheck largest{.name = key_of(quality_fields, &QualityContract::max_dihedral_deg),
                          .measure = "the largest dihedral angle",
                          .value = quality.max_dihedral_deg,
                          .limit = contract.max_dihedral_deg,
                          .unit = "degrees",
                          .met = quality.max_dihedral_deg <= contract.max_dihedral_deg};
    // A tetrahedron that is too flat mostly has both angles: its surroundings are made finer as one.
    std::vector<Eigen::Vector3d> places;
    double size = 0;
    for (const WorstTetrahedron& worst : quality.worst) {
        if (worst.min_dihedral_deg == quality.min_dihedral_deg) smallest.at = worst.centroid;
        if (worst.max_dihedral_deg == quality.max_dihedral_deg) largest.at = worst.centroid;
        if (worst.min_dihedral_deg >= contract.min_dihedral_deg &&
            worst.max_dihedral_deg <= contract.max_dihedral_deg)
            continue;
        places.push_back(worst.centroid);
        size = std::max(size, longest_edge(mesh, worst.tetrahedron));
    }
    for (ContractCheck* angle : {&smallest, &largest})
        if (!angle->met) {
            angle->places = places;
            angle->size = size;
        }
    std::vector<ContractCheck> checks{std::move(smallest), std::move(largest)};
    const auto none = [&](const char* name, const char* measure, std::int64_t count) {
        checks.push_back({.name = name,
                          .measure = measure,
                          .value = static_cast<double>(count),
                          .limit = 0,
                          .met = count == 0});
    };
    none("inverted_tetrahedra", "the number of inverted tetrahedra", quality.inverted);
    none("non_manifold_edges", "the number of non-manifold edges of the boundary",
         quality.boundary.non_manifold_edges);
    none("open_edges", "the number of open edges of the boundary", quality.boundary.open_edges);
    none("boundary_cuts", "the number of pairs of triangles by which the boundary cuts through itself",
         static_cast<std::int64_t>(self_intersections(boundary_surface(mesh).surface).size()));
    return checks;
}

std::vector<ContractCheck> check_fidelity(const QualityContract& contract, const TetMesh& mesh,
                                          const MeshMeasures& measures, const ImageGrid& grid) {
    using Bound = ContractCheck::Bound;
    std::vector<ContractCheck> checks;
    const double coarseness = std::max(1.0, std::cbrt(grid.voxel_volume()));
    const auto add = [&](const std::string& name, const std::string& measure, std::int32_t region,
                         double value, Bound bound, double limit, const char* unit) -> ContractCheck& {
        checks.push_back({.name = name,
                          .measure = measure,
                          .region = region,
                          .region_name = region == 0 ? "" : region_name(mesh, region),
                          .value = value,
                          .bound = bound,
                          .limit = limit,
                          .unit = unit,
                          .met = bound == Bound::at_least ? value >= limit : std::abs(value) <= limit});
        return checks.back();
    };
    const RegionFidelity& body = measures.fidelity.body;
    add(key_of(quality_fields, &QualityContract::min_dice), "the Dice coefficient", 0, body.dice,
        Bound::at_least, contract.min_dice, "");
    add(key_of(quality_fields, &QualityContract::max_centroid_distance), "the centroid's distance", 0,
        body.centroid_distance, Bound::at_most, contract.max_centroid_distance * coarseness, "mm");
    for (const RegionFidelity& region : measures.fidelity.regions) {
        add(key_of(quality_fields, &QualityContract::max_volume_error_percent), "the volume error",
            region.region, region.volume_error_percent, Bound::at_most, contract.max_volume_error_percent,
            "%");
        add(key_of(quality_fields, &QualityContract::min_region_dice), "the Dice coefficient", region.region,
            region.dice, Bound::at_least, contract.min_region_dice, "");
    }
    for (const RegionDistance& distance : measures.distances) {
        add(key_of(quality_fields, &QualityContract::max_mean_distance), "the mean surface distance",
            distance.region, distance.mean, Bound::at_most, contract.max_mean_distance * coarseness, "mm");
        add(key_of(quality_fields, &QualityContract::max_p95_distance),
            "the 95th percentile of the surface distance", distance.region, distance.percentile_95,
            Bound::at_most, contract.max_p95_distance * coarseness, "mm");
        const double limit = contract.max_distance * grid.spacing.norm();
        ContractCheck& largest =
            add(key_of(quality_fields, &QualityContract::max_distance), "the largest surface distance",
                distance.region, distance.maximum, Bound::at_most, limit, "mm");
        largest.at = distance.farthest;
        if (largest.met) continue;
        largest.places = places_beyond(distance, limit);
        largest.size = 2 * limit;
    }
    // A label may have hundreds of components: only those that are missing are listed.
    const std::size_t before = checks.size();
    for (const ComponentCover& component : measures.components)
        if (component.covered < 0.5)
            add("component_share", fmt::format("the share of the component of {:.0f} mm³", component.volume),
                component.region, 100 * component.covered, Bound::at_least, 50, "%")
                .at = component.centroid;
    if (checks.size() == before)
        add("missing_components", "the number of missing components", 0, 0, Bound::at_most, 0, "");
    return checks;
}

std::vector<ContractCheck> misses(std::span<const ContractCheck> checks) {
    std::vector<ContractCheck> result;
    std::ranges::copy_if(checks, std::back_inserter(result),
                         [](const ContractCheck& check) { return !check.met; });
    return result;
}

}  // namespace palpate::meshing
