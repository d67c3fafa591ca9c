// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/contract/contract.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "tools/meshing/files/text.hpp"

namespace palpate {
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

std::string region_name(const TetMesh& mesh, std::int32_t region) {
    const auto found = std::ranges::find(mesh.region_names, region, &Label::value);
    return found != mesh.region_names.end() ? found->name : fmt::format("label {}", region);
}

MeshMeasures measure(const TetMesh& mesh, const RegionLabels& labels,
                     std::span<const TriangleMesh> surfaces) {
    const std::vector<std::int32_t> painted = voxelise(mesh, labels.grid);
    return {measure(mesh), compare(mesh, labels, painted), region_distances(mesh, labels, surfaces),
            cover_components(labels, painted)};
}

std::vector<ContractCheck> check_shape(const QualityContract& contract, const TetMesh& mesh,
                                       const MeshQuality& quality) {
    ContractCheck angles{
        .what = "the range of dihedral angles",
        .found = fmt::format("{:.1f}° ... {:.1f}°", quality.min_dihedral_deg, quality.max_dihedral_deg),
        .limit = fmt::format("{:g}° ... {:g}°", contract.min_dihedral_deg, contract.max_dihedral_deg),
        .kept = quality.min_dihedral_deg >= contract.min_dihedral_deg &&
                quality.max_dihedral_deg <= contract.max_dihedral_deg};
    for (const WorstTetrahedron& worst : quality.worst)
        if (worst.min_dihedral_deg < contract.min_dihedral_deg ||
            worst.max_dihedral_deg > contract.max_dihedral_deg) {
            angles.found +=
                fmt::format("{} {:.1f}° ... {:.1f}° at {}", angles.places.empty() ? ":" : ",",
                            worst.min_dihedral_deg, worst.max_dihedral_deg, place_text(worst.centroid));
            angles.places.push_back(worst.centroid);
            angles.size = std::max(angles.size, longest_edge(mesh, worst.tetrahedron));
        }
    std::vector<ContractCheck> checks{std::move(angles)};
    const auto none = [&](const char* what, std::int64_t count) {
        checks.push_back({.what = what, .found = fmt::format("{}", count), .limit = "0", .kept = count == 0});
    };
    none("the number of inverted tetrahedra", quality.inverted);
    none("the number of non-manifold edges of the boundary", quality.boundary.non_manifold_edges);
    none("the number of open edges of the boundary", quality.boundary.open_edges);
    return checks;
}

std::vector<ContractCheck> check_fidelity(const QualityContract& contract, const TetMesh& mesh,
                                          const MeshMeasures& measures, const ImageGrid& grid) {
    std::vector<ContractCheck> checks;
    const double coarseness = std::max(1.0, std::cbrt(grid.voxel_volume()));
    const auto add = [&](const char* what, std::int32_t region, const std::string& found,
                         const std::string& limit, bool kept) {
        const std::string owner = region == 0 ? "the body" : "'" + region_name(mesh, region) + "'";
        checks.push_back({.what = fmt::format("{} of {}", what, owner),
                          .found = found,
                          .limit = limit,
                          .kept = kept,
                          .region = region});
    };
    const auto at_most = [&](const char* what, std::int32_t region, double found, double limit,
                             const char* unit) {
        add(what, region, fmt::format("{:.3f} {}", found, unit),
            fmt::format("at most {:.3g} {}", limit, unit), std::abs(found) <= limit);
    };
    const auto at_least = [&](const char* what, std::int32_t region, double found, double limit) {
        add(what, region, fmt::format("{:.4f}", found), fmt::format("at least {:g}", limit), found >= limit);
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
    for (const RegionDistance& distance : measures.distances) {
        at_most("the mean surface distance", distance.region, distance.mean,
                contract.max_mean_distance * coarseness, "mm");
        at_most("the 95th percentile of the surface distance", distance.region, distance.percentile_95,
                contract.max_p95_distance * coarseness, "mm");
        const double limit = contract.max_distance * grid.spacing.norm();
        at_most("the largest surface distance", distance.region, distance.maximum, limit, "mm");
        ContractCheck& largest = checks.back();
        if (largest.kept) continue;
        largest.found += " at " + place_text(distance.farthest);
        largest.places = places_beyond(distance, limit);
        largest.size = 2 * limit;
    }
    // A label may have hundreds of components: only those that are missing are listed.
    const std::size_t before = checks.size();
    for (const ComponentCover& component : measures.components)
        if (component.covered < 0.5)
            add("the share in the mesh of a component", component.region,
                fmt::format("{:.0f} % ({:.0f} mm³ around {})", 100 * component.covered, component.volume,
                            place_text(component.centroid)),
                "at least 50 %", false);
    if (checks.size() == before)
        add("the number of missing components", 0, fmt::format("0 of {}", measures.components.size()), "0",
            true);
    return checks;
}

std::vector<ContractCheck> misses(std::span<const ContractCheck> checks) {
    std::vector<ContractCheck> result;
    std::ranges::copy_if(checks, std::back_inserter(result),
                         [](const ContractCheck& check) { return !check.kept; });
    return result;
}

}  // namespace palpate
