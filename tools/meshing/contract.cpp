// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/contract.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace palpate {
namespace {

std::string place(const Eigen::Vector3d& p_P) {
    return fmt::format("({:.1f}, {:.1f}, {:.1f})", p_P.x(), p_P.y(), p_P.z());
}

double longest_edge(const TetMesh& mesh, std::int32_t t) {
    const Tetrahedron& tet = mesh.tetrahedra[static_cast<std::size_t>(t)];
    double longest = 0;
    for (const std::int32_t a : tet)
        for (const std::int32_t b : tet)
            longest = std::max(longest, (mesh.rest_positions[static_cast<std::size_t>(a)] -
                                         mesh.rest_positions[static_cast<std::size_t>(b)])
                                            .norm());
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

std::vector<ComponentCover> cover_components(const TetMesh& mesh, const RegionLabels& labels) {
    const LabelComponents found = find_components(labels);
    const std::vector<std::int32_t> painted = voxelise(mesh, labels.grid);
    std::vector<std::int64_t> covered(found.components.size(), 0);
    for (std::size_t v = 0; v < painted.size(); ++v)
        covered[static_cast<std::size_t>(found.component_of[v])] +=
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

std::string region_name(const TetMesh& mesh, std::int32_t region) {
    const auto found = std::ranges::find(mesh.region_names, region, &Label::value);
    return found != mesh.region_names.end() ? found->name : fmt::format("label {}", region);
}

MeshMeasures measure(const TetMesh& mesh, const RegionLabels& labels,
                     std::span<const TriangleMesh> surfaces) {
    return {measure(mesh), compare(mesh, labels), region_distances(mesh, labels, surfaces),
            cover_components(mesh, labels)};
}

std::vector<ContractMiss> shape_misses(const QualityContract& contract, const TetMesh& mesh,
                                       const MeshQuality& quality) {
    std::vector<ContractMiss> result;
    for (const WorstTetrahedron& worst : quality.worst)
        if (worst.min_dihedral_deg < contract.min_dihedral_deg ||
            worst.max_dihedral_deg > contract.max_dihedral_deg)
            result.push_back(
                {.found = fmt::format("dihedral angles {:.1f}° ... {:.1f}° at {}", worst.min_dihedral_deg,
                                      worst.max_dihedral_deg, place(worst.centroid)),
                 .limit =
                     fmt::format("{:g}° ... {:g}°", contract.min_dihedral_deg, contract.max_dihedral_deg),
                 .places = {worst.centroid},
                 .size = longest_edge(mesh, worst.tetrahedron)});
    const auto none = [&](std::int64_t count, const char* what) {
        if (count > 0) result.push_back({.found = fmt::format("{} {}", count, what), .limit = "0"});
    };
    none(quality.inverted, "inverted tetrahedra");
    none(quality.boundary.non_manifold_edges, "non-manifold edges of the boundary");
    none(quality.boundary.open_edges, "open edges of the boundary");
    return result;
}

std::vector<ContractMiss> fidelity_misses(const QualityContract& contract, const TetMesh& mesh,
                                          const MeshMeasures& measures, const ImageGrid& grid) {
    std::vector<ContractMiss> result;
    const double coarseness = std::max(1.0, std::cbrt(grid.voxel_volume()));
    const auto add = [&](const std::string& what, std::int32_t region, const std::string& found,
                         const std::string& limit) {
        const std::string owner = region == 0 ? "the body" : "'" + region_name(mesh, region) + "'";
        result.push_back(
            {.found = fmt::format("{} of {} is {}", what, owner, found), .limit = limit, .region = region});
    };
    const auto at_most = [&](const char* what, std::int32_t region, double found, double limit,
                             const char* unit, const std::string& where = "") {
        if (!(std::abs(found) <= limit))
            add(what, region, fmt::format("{:.3f} {}{}", found, unit, where),
                fmt::format("at most {:.3g} {}", limit, unit));
    };
    const auto at_least = [&](const char* what, std::int32_t region, double found, double limit) {
        if (!(found >= limit))
            add(what, region, fmt::format("{:.4f}", found), fmt::format("at least {:g}", limit));
    };
    const RegionFidelity& body = measures.fidelity.body;
    at_least("the Dice coefficient", 0, body.dice, contract.min_dice);
    at_most("the centroid's distance", 0, body.centroid_distance, contract.max_centroid_distance * coarseness,
            "mm");
    for (const RegionFidelity& region : measures.fidelity.regions) {
        at_most("the volume error", region.region, region.volume_error_percent,
                contract.max_volume_error_percent, "%");
        at_least("the Dice coefficient", region.region, region.dice, contract.min_region_dice);
    }
    for (const ComponentCover& component : measures.components)
        if (component.covered < 0.5)
            add(fmt::format("the share in the mesh of the component of {:.0f} mm³ around {}",
                            component.volume, place(component.centroid)),
                component.region, fmt::format("{:.0f} %", 100 * component.covered), "at least 50 %");
    for (const RegionDistance& distance : measures.distances) {
        at_most("the mean surface distance", distance.region, distance.mean,
                contract.max_mean_distance * coarseness, "mm");
        at_most("the 95th percentile of the surface distance", distance.region, distance.percentile_95,
                contract.max_p95_distance * coarseness, "mm");
        const std::size_t before = result.size();
        const double limit = contract.max_distance_voxels * grid.spacing.norm();
        at_most("the largest surface distance", distance.region, distance.maximum, limit, "mm",
                " at " + place(distance.farthest));
        if (result.size() > before) {
            result.back().places = places_beyond(distance, limit);
            result.back().size = 2 * limit;
        }
    }
    return result;
}

}  // namespace palpate
